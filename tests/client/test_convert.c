/* Readers of other programs' recordings: what becomes of each field, and what is refused. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "client/gazectl/convert/recording_format.h"
#include "tests/base/captured_log.h"

enum { RECORDS_MAX = 32 };

static struct {
	struct gz_gaze_log_header header;
	size_t headers, count;
	struct gz_gaze_log_record record[RECORDS_MAX];
} taken;

static enum gz_result take_header(void *user, const struct gz_gaze_log_header *header)
{
	(void)user;
	taken.header = *header;
	taken.headers++;
	assert_int_equal(taken.count, 0);
	return GZ_OK;
}

static enum gz_result take_record(void *user, const struct gz_gaze_log_record *record)
{
	(void)user;
	assert_int_equal(taken.headers, 1);
	if (taken.count < RECORDS_MAX)
		taken.record[taken.count] = *record;
	taken.count++;
	return GZ_OK;
}

static const struct gz_recording_sink sink = { NULL, take_header, take_record };

static struct gz_convert_settings settings;
static struct gz_convert_counts counts;
static struct captured_log captured;

static int set_up(void **state)
{
	(void)state;
	memset(&taken, 0, sizeof taken);
	captured_log_init(&captured, NULL);
	settings = (struct gz_convert_settings) { .name = "file", .log = &captured.log };
	counts = (struct gz_convert_counts) { 0 };
	return 0;
}

static enum gz_result read_text(const struct gz_recording_reader *reader, const char *text)
{
	struct gz_text_lines *lines = NULL;
	assert_int_equal(gz_text_lines_open_memory(text, strlen(text), &lines), GZ_OK);
	enum gz_result result = reader->read(lines, &settings, &sink, &counts);
	gz_text_lines_close(&lines);
	return result;
}

static const struct gz_sample *sample(size_t index)
{
	assert_true(index < taken.count);
	assert_int_equal(taken.record[index].kind, GZ_GAZE_LOG_SAMPLE);
	return &taken.record[index].sample;
}

static void assert_near(double value, double wanted)
{
	if (!(fabs(value - wanted) <= 1e-6))
		fail_msg("%.9g, wanted %.9g", value, wanted);
}

/* Two blocks at 2000 Hz, where two samples have the same millisecond. */
static const char eyelink_text[] =
	"** CONVERTED FROM a.edf using edfapi\n"
	"MSG\t90 !CAL before anything\n"
	"MSG\t99 GAZE_COORDS 0.00 0.00 1023.00 767.00\n"
	"START\t100 \tLEFT\tRIGHT\tSAMPLES\tEVENTS\n"
	"PUPIL\tAREA\n"
	"SAMPLES\tGAZE\tLEFT\tRIGHT\tRATE\t2000.00\tTRACKING\tCR\tFILTER\t2\n"
	"100\t  512.0\t  384.0\t 1037.0\t  102.4\t  76.8\t 900.0\t.....\n"
	"100\t  512.0\t  384.0\t 1037.0\t   .\t   .\t    0.0\t.....\n"
	"EFIX L   100 101 2 512.0 384.0 1037\n"
	"MSG\t101 a mark with\ta tab\n"
	"nonsense\n"
	"1e9x\t1\t2\t3\t4\t5\t6\n"
	"END\t102 \tSAMPLES\tEVENTS\tRES\t 38.54\t 31.12\n"
	"MSG\t150 between\n"
	"200\t 1\t 2\t 3\t 4\t 5\t 6\n"
	"START\t300 \tRIGHT\tSAMPLES\tEVENTS\n"
	"SAMPLES\tGAZE\tRIGHT\tRATE\t 500.00\tTRACKING\tCR\n"
	"300.5\t  -10.24\t  384.0\t 1037.0\t...\n";

static void eyelink_samples_marks_and_pauses_are_read(void **state)
{
	(void)state;
	assert_int_equal(read_text(&gz_recording_reader_eyelink, eyelink_text), GZ_OK);
	assert_int_equal(counts.samples, 3);
	assert_int_equal(counts.skipped, 1);
	assert_string_equal(taken.header.tracker, "EyeLink");
	assert_near(taken.header.rate_hz, 2000);
	assert_false(taken.header.has_display); /* its size is unknown */
	assert_int_equal(taken.count, 7);
	assert_int_equal(sample(0)->host_ns, 100 * GZ_NS_PER_MS);
	assert_int_equal(sample(1)->host_ns, 100 * GZ_NS_PER_MS + GZ_NS_PER_MS / 2);
	assert_true(sample(0)->eye[GZ_EYE_LEFT].valid && sample(0)->eye[GZ_EYE_RIGHT].valid);
	assert_near((double)sample(0)->eye[GZ_EYE_LEFT].point.x, 0.5);
	assert_near((double)sample(0)->eye[GZ_EYE_LEFT].point.y, 0.5);
	assert_near((double)sample(0)->eye[GZ_EYE_RIGHT].point.x, 0.1);
	assert_near((double)sample(0)->eye[GZ_EYE_RIGHT].point.y, 0.1);
	assert_near((double)sample(0)->eye[GZ_EYE_LEFT].pupil_mm, 1037);
	assert_string_equal(taken.header.pupil_unit, "arbitrary (EyeLink area)");
	assert_false(sample(1)->eye[GZ_EYE_RIGHT].valid);
	assert_true(isnan(sample(1)->eye[GZ_EYE_RIGHT].pupil_mm)); /* 0: there was none */
	assert_int_equal(taken.record[2].kind, GZ_GAZE_LOG_MARK);
	assert_string_equal(taken.record[2].text, "fixation");
	assert_int_equal(taken.record[2].host_ns, 100 * GZ_NS_PER_MS);
	assert_true(taken.record[2].duration_ns == 2 * GZ_NS_PER_MS);
	assert_string_equal(taken.record[2].keys, "{\"source\":\"EyeLink\",\"eye\":\"left\","
						  "\"x_px\":512,\"y_px\":384,\"pupil\":1037}");
	assert_string_equal(taken.record[3].text, "a mark with\ta tab");
	assert_true(taken.record[3].duration_ns == 0);
	assert_string_equal(taken.record[3].keys, "");
	assert_string_equal(taken.record[4].text, "between");
	assert_int_equal(taken.record[5].kind, GZ_GAZE_LOG_GAP);
	assert_int_equal(taken.record[5].host_ns, 300 * GZ_NS_PER_MS);
	assert_int_equal(sample(6)->host_ns, 300 * GZ_NS_PER_MS + GZ_NS_PER_MS / 2);
	assert_false(sample(6)->eye[GZ_EYE_LEFT].valid);
	assert_near((double)sample(6)->eye[GZ_EYE_RIGHT].point.x, -0.01); /* beyond the edge */
}

/* In some files the message comes between START and the first sample, at START's time. */
static void eyelink_events_of_the_parser_become_marks(void **state)
{
	(void)state;
	static const char text[] =
		"ESACC R  90 95 6 1 2 3 4 5 6\n"
		"MSG\t99 GAZE_COORDS 0.00 0.00 1023.00 767.00\n"
		"START\t100 \tRIGHT\tSAMPLES\tEVENTS\n"
		"PUPIL\tDIAMETER\n"
		"SAMPLES\tGAZE\tRIGHT\tRATE\t 500.00\tTRACKING\tCR\n"
		"100\t  512.0\t  384.0\t 1037.0\t...\n"
		"SSACC R  100\n"
		"ESACC R  100\t110\t12\t  512.0\t  384.5\t   .\t   .\t   5.25\t    300\n"
		"EBLINK L 120\t130\t12\n"
		"EFIX R   nonsense\n";
	assert_int_equal(read_text(&gz_recording_reader_eyelink, text), GZ_OK);
	assert_string_equal(taken.header.pupil_unit, "arbitrary (EyeLink diameter)");
	assert_int_equal(counts.skipped, 2); /* before the first block, and nonsense */
	assert_int_equal(taken.count, 3);
	assert_string_equal(taken.record[1].text, "saccade");
	assert_string_equal(taken.record[1].keys,
			    "{\"source\":\"EyeLink\",\"eye\":\"right\",\"start_x_px\":512,"
			    "\"start_y_px\":384.5,\"amplitude_deg\":5.25,"
			    "\"peak_velocity_deg_s\":300}");
	assert_string_equal(taken.record[2].text, "blink");
	assert_int_equal(taken.record[2].host_ns, 120 * GZ_NS_PER_MS);
	assert_string_equal(taken.record[2].keys, "{\"source\":\"EyeLink\",\"eye\":\"left\"}");
}

static void eyelink_mark_at_the_start_of_a_block_is_kept(void **state)
{
	(void)state;
	static const char text[] = "MSG\t99 GAZE_COORDS 0.00 0.00 1023.00 767.00\n"
				   "MSG\t80 !MODE RECORD of no block\n"
				   "START\t100 \tRIGHT\tSAMPLES\tEVENTS\n"
				   "PRESCALER\t1\n"
				   "SAMPLES\tGAZE\tRIGHT\tRATE\t 500.00\tTRACKING\tCR\n"
				   "MSG\t100 !MODE RECORD CR 500 2 1 R\n"
				   "100\t  512.0\t  384.0\t 1037.0\t...\n";
	assert_int_equal(read_text(&gz_recording_reader_eyelink, text), GZ_OK);
	assert_int_equal(taken.count, 2);
	assert_int_equal(taken.record[0].kind, GZ_GAZE_LOG_MARK);
	assert_int_equal(taken.record[0].host_ns, 100 * GZ_NS_PER_MS);
	assert_string_equal(taken.record[0].text, "!MODE RECORD CR 500 2 1 R");
	assert_near(taken.header.rate_hz, 500);
	assert_int_equal(sample(1)->host_ns, 100 * GZ_NS_PER_MS);
}

/* In other files it comes just before START. */
static void eyelink_mark_just_before_the_first_block_is_kept(void **state)
{
	(void)state;
	static const char text[] = "MSG\t90 GAZE_COORDS 0.00 0.00 1023.00 767.00\n"
				   "MSG\t%d !MODE RECORD CR 500 2 1 R\n"
				   "START\t100 \tRIGHT\tSAMPLES\tEVENTS\n"
				   "SAMPLES\tGAZE\tRIGHT\tRATE\t 500.00\tTRACKING\tCR\n"
				   "100\t  512.0\t  384.0\t 1037.0\t...\n"
				   "102\t  512.0\t  384.0\t 1037.0\t...\n";
	char file[sizeof text + 16];
	snprintf(file, sizeof file, text, 99);
	assert_int_equal(read_text(&gz_recording_reader_eyelink, file), GZ_OK);
	assert_int_equal(taken.count, 3);
	assert_int_equal(taken.record[0].kind, GZ_GAZE_LOG_MARK);
	assert_int_equal(taken.record[0].host_ns, 99 * GZ_NS_PER_MS);
	assert_string_equal(taken.record[0].text, "!MODE RECORD CR 500 2 1 R");
	set_up(NULL);
	snprintf(file, sizeof file, text, 91);
	assert_int_equal(read_text(&gz_recording_reader_eyelink, file), GZ_OK);
	assert_int_equal(taken.count, 2); /* it belongs to nothing that was recorded */
}

static void eyelink_display_is_complete_with_what_the_user_knows(void **state)
{
	(void)state;
	settings.display_mm[0] = 380;
	settings.display_mm[1] = 300;
	settings.distance_mm = 670;
	assert_int_equal(read_text(&gz_recording_reader_eyelink, eyelink_text), GZ_OK);
	assert_true(taken.header.has_display);
	assert_int_equal(taken.header.display.px[0], 1024);
	assert_int_equal(taken.header.display.px[1], 768);
}

static void eyelink_of_no_gaze_or_no_screen_is_refused_with_the_remedy(void **state)
{
	(void)state;
	assert_int_equal(read_text(&gz_recording_reader_eyelink,
				   "START\t1 \tLEFT\nSAMPLES\tHREF\tLEFT\tRATE\t500\n1\t2\t3\t4\n"),
			 GZ_ERR_UNSUPPORTED);
	assert_non_null(strstr(captured.last, "file:2"));
	assert_non_null(strstr(captured.last, "edf2asc"));
	assert_int_equal(read_text(&gz_recording_reader_eyelink,
				   "START\t1 \tLEFT\nSAMPLES\tGAZE\tLEFT\tRATE\t500\n1\t2\t3\t4\n"),
			 GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "--display.px"));
}

static void pupil_points_are_turned_and_eyes_told_apart(void **state)
{
	(void)state;
	static const char text[] =
		"\xef\xbb\xbfgaze_timestamp,world_index,confidence,norm_pos_x,norm_pos_y,base_data,"
		"eye_center0_3d_x,eye_center0_3d_y,eye_center0_3d_z,gaze_normal0_x,gaze_normal0_y,"
		"gaze_normal0_z\r\n"
		"1216.218711,347,0.75,0.25,0.1,1216.2-0 1216.3-1,1,2,3,0,0,1\r\n"
		"1216.228711,347,0,0.25,0.1,1216.2-1,,,,,,\r\n"
		"later,347,1,0.25,0.1,,,,,,,\r\n"
		"1216.3,347,1.5,0.25,0.1,,,,,,,\r\n";
	assert_int_equal(read_text(&gz_recording_reader_pupil, text), GZ_OK);
	assert_int_equal(counts.samples, 2);
	assert_int_equal(counts.skipped, 2);
	assert_non_null(strstr(captured.last, "scene camera"));
	assert_true(taken.header.scene_camera);
	const struct gz_eye_sample *right = &sample(0)->eye[GZ_EYE_RIGHT];
	const struct gz_eye_sample *left = &sample(0)->eye[GZ_EYE_LEFT];
	assert_int_equal(sample(0)->host_ns, 1216218711000);
	assert_near((double)right->point.x, 0.25);
	assert_near((double)right->point.y, 0.9); /* from the top */
	assert_near((double)right->confidence, 0.75);
	assert_near((double)right->origin_mm[2], 3);
	assert_near((double)right->direction[2], 1);
	assert_true(left->valid && isnan(left->origin_mm[0]));
	assert_false(sample(1)->eye[GZ_EYE_RIGHT].valid); /* only eye 1 was there */
	assert_true(isnan(sample(1)->eye[GZ_EYE_RIGHT].confidence));
	assert_false(sample(1)->eye[GZ_EYE_LEFT].valid); /* confidence 0 */
}

static void pupil_without_its_columns_is_refused(void **state)
{
	(void)state;
	assert_int_equal(read_text(&gz_recording_reader_pupil, "gaze_timestamp,norm_pos_x\n1,2\n"),
			 GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "norm_pos_y"));
	assert_int_equal(read_text(&gz_recording_reader_pupil, ""), GZ_ERR_FORMAT);
	assert_int_equal(taken.headers, 0);
}

static void tobii_pro_lab_is_read_by_the_names_of_its_columns(void **state)
{
	(void)state;
	static const char text[] =
		"Recording timestamp [\xce\xbcs]\tSensor\tEvent\tEyetracker timestamp [\xce\xbcs]\t"
		"Recording resolution width\tRecording resolution height\t"
		"Gaze point left X [DACS px]\tGaze point left Y [DACS px]\t"
		"Gaze point right X [DACS px]\tGaze point right Y [DACS px]\t"
		"Pupil diameter left [mm]\tValidity left\tValidity right\t"
		"Eye position left X [DACSmm]\tEye position left Y [DACSmm]\t"
		"Eye position left Z [DACSmm]\n"
		"1000\t\tRecordingStart\t\t1920\t1080\t\t\t\t\t\t\t\t\t\t\n"
		"2000\tEye Tracker\t\t900\t1920\t1080\t960\t540\t480\t270\t\"3,5\"\tValid\tInvalid"
		"\t-20\t10\t650,25\n"
		"2500\tMouse\t\t\t1920\t1080\t\t\t\t\t\t\t\t\t\t\n"
		"3000\tEye Tracker\t\t1900\t1920\t1080\t\t\t\t\t\tInvalid\tInvalid\t\t\t\n";
	assert_int_equal(read_text(&gz_recording_reader_tobii, text), GZ_OK);
	assert_int_equal(counts.samples, 2);
	assert_int_equal(taken.count, 3);
	assert_string_equal(taken.record[0].text, "RecordingStart");
	assert_int_equal(sample(1)->host_ns, 2000 * GZ_NS_PER_US);
	assert_int_equal(sample(1)->device_ns, 900 * GZ_NS_PER_US);
	const struct gz_eye_sample *left = &sample(1)->eye[GZ_EYE_LEFT];
	assert_true(left->valid);
	assert_near((double)left->point.x, 0.5);
	assert_near((double)left->point.y, 0.5);
	assert_near((double)left->pupil_mm, 3.5);
	assert_near((double)left->origin_mm[2], 650.25);
	assert_false(sample(1)->eye[GZ_EYE_RIGHT].valid);
	assert_near((double)sample(1)->eye[GZ_EYE_RIGHT].point.x, 0.25);
	assert_false(sample(2)->eye[GZ_EYE_LEFT].valid);
}

static void tobii_studio_and_the_matlab_matrices_are_read(void **state)
{
	(void)state;
	settings.display_px[0] = 1000;
	settings.display_px[1] = 500;
	assert_int_equal(
		read_text(&gz_recording_reader_tobii,
			  "RecordingTimestamp\tGazePointLeftX (ADCSpx)\tGazePointLeftY (ADCSpx)\t"
			  "ValidityLeft\tPupilLeft\n12\t100\t50\t0\t4,1\n15\t100\t50\t4\t\n"),
		GZ_OK);
	assert_int_equal(sample(0)->host_ns, 12 * GZ_NS_PER_MS);
	assert_int_equal(sample(0)->device_ns, GZ_NO_DEVICE_TIME);
	assert_near((double)sample(0)->eye[GZ_EYE_LEFT].point.x, 0.1);
	assert_near((double)sample(0)->eye[GZ_EYE_LEFT].point.y, 0.1);
	assert_near((double)sample(0)->eye[GZ_EYE_LEFT].pupil_mm, 4.1);
	assert_false(sample(1)->eye[GZ_EYE_LEFT].valid);
	set_up(NULL);
	settings.display_px[0] = 1000;
	settings.display_px[1] = 500;
	/* An empty validity was not measured: a sample, and nothing to complain about. */
	assert_int_equal(
		read_text(&gz_recording_reader_tobii,
			  "RecordingTimestamp\tGazePointLeftX (ADCSpx)\tGazePointLeftY (ADCSpx)\t"
			  "ValidityLeft\n12\t100\t50\t\n13\t100\t50\t0\n"),
		GZ_OK);
	assert_int_equal(counts.samples, 2);
	assert_int_equal(counts.skipped, 0);
	assert_false(sample(0)->eye[GZ_EYE_LEFT].valid);
	assert_true(sample(1)->eye[GZ_EYE_LEFT].valid);
	set_up(NULL);
	assert_int_equal(
		read_text(&gz_recording_reader_tobii,
			  "Time\tRGazePos2dx\tRGazePos2dy\tRValidity\tRPupilDm\tRelTimestamp\n"
			  "7284782021\t.4\t.6\t1\t4.3\t3.5\n"),
		GZ_OK);
	assert_int_equal(sample(0)->device_ns, 7284782021 * GZ_NS_PER_US);
	assert_int_equal(sample(0)->host_ns, 3500 * GZ_NS_PER_US);
	assert_true(sample(0)->eye[GZ_EYE_RIGHT].valid);
	assert_near((double)sample(0)->eye[GZ_EYE_RIGHT].point.y, 0.6);
}

static void tobii_without_a_display_or_times_is_refused_with_the_remedy(void **state)
{
	(void)state;
	assert_int_equal(read_text(&gz_recording_reader_tobii,
				   "RecordingTimestamp\tGazePointLeftX (ADCSpx)\t"
				   "GazePointLeftY (ADCSpx)\n12\t100\t50\n"),
			 GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "--display.px"));
	assert_int_equal(read_text(&gz_recording_reader_tobii,
				   "GazePointLeftX (ADCSpx)\tGazePointLeftY (ADCSpx)\n100\t50\n"),
			 GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "timestamp"));
	assert_int_equal(taken.headers, 0);
}

static const char arff_text[] = "%@METADATA distance_mm 450.0\n"
				"%@METADATA height_mm 225.0\n"
				"%@METADATA width_mm 400.0\n"
				"%@METADATA width_px 1280.0\n"
				"%@METADATA height_px 720.0\n"
				"@RELATION gaze_recording\n"
				"\n"
				"@attribute time INTEGER\n"
				"@ATTRIBUTE x NUMERIC\n"
				"@ATTRIBUTE y NUMERIC\n"
				"@ATTRIBUTE confidence NUMERIC\n"
				"@ATTRIBUTE handlabeller1 {FIX,SACCADE}\n"
				"@DATA\n"
				"1000,640.0,180.0,1.0,FIX\n"
				"% a remark\n"
				"5000,-12.8,720.0,0.0,FIX\n"
				"?,1,2,1,FIX\n"
				"9000,?,180.0,1.0,SACCADE\n";

static void arff_has_its_display_and_points_of_both_eyes(void **state)
{
	(void)state;
	assert_int_equal(read_text(&gz_recording_reader_arff, arff_text), GZ_OK);
	assert_int_equal(counts.samples, 3);
	assert_int_equal(counts.skipped, 1);
	assert_true(taken.header.has_display);
	assert_int_equal(taken.header.display.px[0], 1280);
	assert_near(taken.header.display.mm[1], 225);
	assert_near(taken.header.display.distance_mm, 450);
	assert_int_equal(sample(0)->host_ns, GZ_NS_PER_MS);
	assert_int_equal(sample(0)->device_ns, GZ_NO_DEVICE_TIME);
	assert_near((double)sample(0)->point.x, 0.5);
	assert_near((double)sample(0)->point.y, 0.25);
	assert_true(sample(0)->valid && gz_sample_combined_only(sample(0)));
	assert_near((double)sample(1)->point.x, -0.01);
	assert_false(sample(1)->valid); /* confidence 0 */
	assert_false(sample(2)->valid);
	set_up(NULL);
	settings.distance_mm = 700;
	assert_int_equal(read_text(&gz_recording_reader_arff, arff_text), GZ_OK);
	assert_near(taken.header.display.distance_mm, 700); /* the user knows better */
}

static void arff_without_a_display_or_columns_is_refused(void **state)
{
	(void)state;
	assert_int_equal(read_text(&gz_recording_reader_arff,
				   "@RELATION r\n@ATTRIBUTE time INTEGER\n@ATTRIBUTE x NUMERIC\n"
				   "@ATTRIBUTE y NUMERIC\n@DATA\n1,2,3\n"),
			 GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "--display.px"));
	assert_int_equal(read_text(&gz_recording_reader_arff,
				   "@RELATION r\n@ATTRIBUTE time INTEGER\n@ATTRIBUTE xy NUMERIC\n"
				   "@DATA\n1,2\n"),
			 GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "file:4"));
	assert_int_equal(taken.headers, 0);
}

static const char smi_text[] =
	"## [iView]\n"
	"## Sample Rate:\t50\n"
	"## Calibration Area:\t1000\t500\n"
	"## Stimulus Dimension [mm]:\t300\t200\n"
	"## Head Distance [mm]:\t800\n"
	"## Format:\tLEFT, RAW, DIAMETER, CR, POR, QUALITY, MSG\n"
	"## \n"
	"Time\tType\tTrial\tL Raw X [px]\tL Raw Y [px]\tL Dia X [px]\tL POR X [px]\tL POR Y [px]\n"
	"2152080664\tMSG\t1\t# Message: a picture.bmp\n"
	"2152092084\tSMP\t1\t212.15\t75.65\t33.39\t0.00\t0.00\n"
	"2152112047\tSMP\t1\t212.28\t75.82\t0.00\t250.00\t125.00\n"
	"2152112050\tXYZ\t1\t212.28\t75.82\t32.90\t250.00\t125.00\n"
	"2226853655\tSMP\t2\t212.28\t75.82\t32.90\t1000.00\t125.00\n";

static void smi_samples_messages_and_trials_are_read(void **state)
{
	(void)state;
	assert_int_equal(read_text(&gz_recording_reader_smi, smi_text), GZ_OK);
	assert_int_equal(counts.samples, 3);
	assert_int_equal(counts.skipped, 1);
	assert_int_equal(taken.count, 5);
	assert_near(taken.header.rate_hz, 50);
	assert_true(taken.header.has_display);
	assert_int_equal(taken.header.display.px[1], 500);
	assert_near(taken.header.display.mm[0], 300);
	assert_near(taken.header.display.distance_mm, 800);
	assert_string_equal(taken.header.pupil_unit, "arbitrary (SMI px of the eye camera)");
	assert_int_equal(taken.record[0].kind, GZ_GAZE_LOG_MARK);
	assert_string_equal(taken.record[0].text, "a picture.bmp");
	assert_int_equal(taken.record[0].host_ns, 2152080664 * GZ_NS_PER_US);
	const struct gz_eye_sample *left = &sample(1)->eye[GZ_EYE_LEFT];
	assert_false(left->valid); /* 0 0 */
	assert_near((double)left->pupil_mm, 33.39f);
	left = &sample(2)->eye[GZ_EYE_LEFT];
	assert_true(left->valid && isnan(left->pupil_mm));
	assert_near((double)left->point.x, 0.25);
	assert_near((double)left->point.y, 0.25);
	assert_false(sample(2)->eye[GZ_EYE_RIGHT].valid);
	assert_int_equal(taken.record[3].kind, GZ_GAZE_LOG_GAP);
	assert_int_equal(sample(4)->device_ns, 2226853655 * GZ_NS_PER_US);
}

static void smi_pupils_in_mm_are_preferred(void **state)
{
	(void)state;
	assert_int_equal(read_text(&gz_recording_reader_smi,
				   "## [BeGaze]\n## Calibration Area:\t1000\t500\n"
				   "Time\tType\tTrial\tR Dia X [px]\tR Mapped Diameter [mm]\t"
				   "R POR X [px]\tR POR Y [px]\n"
				   "1\tSMP\t1\t33\t3.5\t100\t100\n"),
			 GZ_OK);
	assert_string_equal(taken.header.pupil_unit, "");
	assert_near((double)sample(0)->eye[GZ_EYE_RIGHT].pupil_mm, 3.5);
}

static void smi_without_points_or_a_display_is_refused(void **state)
{
	(void)state;
	assert_int_equal(read_text(&gz_recording_reader_smi,
				   "## [iView]\nTime\tType\tTrial\tL Raw X [px]\n1\tSMP\t1\t2\n"),
			 GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "POR"));
	assert_int_equal(read_text(&gz_recording_reader_smi,
				   "## [iView]\nTime\tType\tTrial\tL POR X [px]\tL POR Y [px]\n"
				   "1\tSMP\t1\t2\t3\n"),
			 GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, "--display.px"));
}

static void table_columns_are_those_that_the_user_names(void **state)
{
	(void)state;
	settings.display_px[0] = 1000;
	settings.display_px[1] = 500;
	settings.table = (struct gz_convert_table) {
		.columns =
			"time=t [ms];left_x=lx;left_y=ly;left_pupil_mm=d;left_confidence=c;mark=m",
		.time_unit = GZ_TABLE_MS,
		.points = GZ_TABLE_PX,
	};
	assert_int_equal(read_text(&gz_recording_reader_table, "m;t [ms];lx;ly;d;c\n"
							       ";12,5;100;50;3,5;1\n"
							       "go;14;100;50;;0\n"
							       ";;100;50;3;1\n"
							       ";15;;50;3;1\n"),
			 GZ_OK);
	assert_int_equal(counts.samples, 3);
	assert_int_equal(counts.skipped, 1);
	assert_int_equal(sample(0)->host_ns, 12500 * GZ_NS_PER_US);
	assert_true(sample(0)->eye[GZ_EYE_LEFT].valid);
	assert_near((double)sample(0)->eye[GZ_EYE_LEFT].point.x, 0.1);
	assert_near((double)sample(0)->eye[GZ_EYE_LEFT].point.y, 0.1);
	assert_near((double)sample(0)->eye[GZ_EYE_LEFT].pupil_mm, 3.5);
	assert_false(sample(0)->valid || sample(0)->eye[GZ_EYE_RIGHT].valid);
	assert_string_equal(taken.record[1].text, "go");
	assert_int_equal(taken.record[1].host_ns, 14 * GZ_NS_PER_MS);
	assert_false(sample(2)->eye[GZ_EYE_LEFT].valid); /* confidence 0 */
	assert_false(sample(3)->eye[GZ_EYE_LEFT].valid);
}

/* As the tables of GazeCom in OEMC: no times, several observers, 0 0 with confidence 0. */
static void table_lines_of_one_observer_at_equal_intervals(void **state)
{
	(void)state;
	settings.rate_hz = 250;
	settings.table = (struct gz_convert_table) { .columns = "x=x;y=y;confidence=confidence",
						     .where = "observer=B" };
	assert_int_equal(read_text(&gz_recording_reader_table, "observer\tx\ty\tconfidence\tlabel\n"
							       "A\t0.1\t0.2\t1\tF\n"
							       "B\t0.25\t0.75\t1\tF\n"
							       "B\t0\t0\t0\tB\n"
							       "C\t0.3\t0.2\t1\tF\n"),
			 GZ_OK);
	assert_int_equal(counts.samples, 2);
	assert_near(taken.header.rate_hz, 250);
	assert_true(sample(0)->valid);
	assert_int_equal(sample(0)->host_ns, 0);
	assert_near((double)sample(0)->point.y, 0.75);
	assert_false(sample(1)->valid);
	assert_int_equal(sample(1)->host_ns, 4 * GZ_NS_PER_MS);
}

static void table_that_is_not_told_enough_is_refused_with_the_remedy(void **state)
{
	(void)state;
	static const struct {
		struct gz_convert_table table;
		const char *said;
	} cases[] = {
		{ { 0 }, "--table.columns" },
		{ { .columns = "time=t;x=a;y=nowhere" }, "no column \"nowhere\"" },
		{ { .columns = "time=t;z=a;y=b" }, "\"z=a\" is not MEANING=COLUMN" },
		{ { .columns = "time" }, "MEANING=COLUMN" },
		{ { .columns = "x=a;y=b" }, "--rate-hz" },
		{ { .columns = "time=t;x=a;y=b", .points = GZ_TABLE_PX }, "--display.px" },
		{ { .columns = "time=t;x=a;y=b", .points = GZ_TABLE_MM }, "--display.mm" },
		{ { .columns = "time=t;x=a;y=b", .where = "c=1" }, "--table.where" },
		{ { .columns = "time=t;x=a;y=b", .where = "a" }, "--table.where" },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		settings.table = cases[i].table;
		assert_int_equal(read_text(&gz_recording_reader_table, "t,a,b\n1,2,3\n"),
				 GZ_ERR_FORMAT);
		if (!strstr(captured.last, cases[i].said))
			fail_msg("\"%s\" lacks \"%s\"", captured.last, cases[i].said);
	}
	assert_int_equal(read_text(&gz_recording_reader_table, ""), GZ_ERR_FORMAT);
	assert_int_equal(taken.headers, 0);
}

static void formats_are_recognised_by_their_first_line(void **state)
{
	(void)state;
	assert_ptr_equal(gz_recording_reader_recognise("** CONVERTED FROM x.edf"),
			 &gz_recording_reader_eyelink);
	assert_ptr_equal(gz_recording_reader_recognise(
				 "timestamp,confidence,norm_pos_x,norm_pos_y,base_data"),
			 &gz_recording_reader_pupil);
	assert_ptr_equal(gz_recording_reader_recognise(
				 "Recording timestamp [ms]\tGaze point left X [DACS px]"),
			 &gz_recording_reader_tobii);
	assert_ptr_equal(gz_recording_reader_recognise("@RELATION gaze"),
			 &gz_recording_reader_arff);
	assert_ptr_equal(gz_recording_reader_recognise("%@METADATA width_px 1280"),
			 &gz_recording_reader_arff);
	assert_ptr_equal(gz_recording_reader_recognise("## [iView]"), &gz_recording_reader_smi);
	assert_null(gz_recording_reader_recognise("time,x,y"));
	assert_null(gz_recording_reader_recognise(""));
	assert_ptr_equal(gz_recording_reader_find("tobii"), &gz_recording_reader_tobii);
	assert_null(gz_recording_reader_find("tobi"));
	assert_ptr_equal(gz_recording_writer_of("a_physio.tsv.gz"), &gz_recording_writer_bids);
	assert_null(gz_recording_writer_of(".gzl"));
}

static void line_too_long_is_skipped_and_the_next_one_read(void **state)
{
	(void)state;
	size_t size = GZ_TEXT_LINE_SIZE + 100;
	char *text = malloc(size + 64), *line;
	assert_non_null(text);
	memset(text, 'a', size);
	strcpy(text + size, "\nsecond\r\nlast");
	struct gz_text_lines *lines = NULL;
	assert_int_equal(gz_text_lines_open_memory(text, strlen(text), &lines), GZ_OK);
	assert_int_equal(gz_text_lines_next(lines, &line), GZ_ERR_FULL);
	assert_int_equal(gz_text_lines_next(lines, &line), GZ_OK);
	assert_string_equal(line, "second");
	gz_text_lines_again(lines);
	assert_int_equal(gz_text_lines_next(lines, &line), GZ_OK);
	assert_string_equal(line, "second");
	assert_int_equal(gz_text_lines_number(lines), 2);
	assert_int_equal(gz_text_lines_next(lines, &line), GZ_OK);
	assert_string_equal(line, "last");
	assert_int_equal(gz_text_lines_next(lines, &line), GZ_ERR_END);
	gz_text_lines_close(&lines);
	free(text);
}

static void text_that_is_no_utf_8_is_mended_and_cut_between_characters(void **state)
{
	(void)state;
	char text[8];
	gz_text_copy(text, sizeof text,
		     "a\xff"
		     "b\xc3");
	assert_string_equal(text, "a?b?");
	gz_text_copy(text, sizeof text, "123456\xc3\xa4");
	assert_string_equal(text, "123456");
	gz_text_copy(text, sizeof text, "12345\xc3\xa4");
	assert_string_equal(text, "12345\xc3\xa4");
}

#define TEST(function) cmocka_unit_test_setup(function, set_up)

TEST_SUITE(convert)
{
	const struct CMUnitTest tests[] = {
		TEST(eyelink_samples_marks_and_pauses_are_read),
		TEST(eyelink_events_of_the_parser_become_marks),
		TEST(eyelink_mark_at_the_start_of_a_block_is_kept),
		TEST(eyelink_mark_just_before_the_first_block_is_kept),
		TEST(eyelink_display_is_complete_with_what_the_user_knows),
		TEST(eyelink_of_no_gaze_or_no_screen_is_refused_with_the_remedy),
		TEST(pupil_points_are_turned_and_eyes_told_apart),
		TEST(pupil_without_its_columns_is_refused),
		TEST(tobii_pro_lab_is_read_by_the_names_of_its_columns),
		TEST(tobii_studio_and_the_matlab_matrices_are_read),
		TEST(tobii_without_a_display_or_times_is_refused_with_the_remedy),
		TEST(arff_has_its_display_and_points_of_both_eyes),
		TEST(arff_without_a_display_or_columns_is_refused),
		TEST(smi_samples_messages_and_trials_are_read),
		TEST(smi_pupils_in_mm_are_preferred),
		TEST(smi_without_points_or_a_display_is_refused),
		TEST(table_columns_are_those_that_the_user_names),
		TEST(table_lines_of_one_observer_at_equal_intervals),
		TEST(table_that_is_not_told_enough_is_refused_with_the_remedy),
		TEST(formats_are_recognised_by_their_first_line),
		TEST(line_too_long_is_skipped_and_the_next_one_read),
		TEST(text_that_is_no_utf_8_is_mended_and_cut_between_characters),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
