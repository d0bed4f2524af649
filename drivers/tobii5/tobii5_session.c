#include "drivers/tobii5/tobii5_session.h"

#include "base/clock.h"

static const char no_answer[] =
	"the tracker does not answer; its firmware may speak another protocol, or it needs to be "
	"plugged in again";
static const char no_area[] = "the tracker does not state its display area";
static const char lost_area[] =
	"the tracker has lost its display area, as without power; set tobii5.screen_mm";
static const char kept_area[] =
	"the tracker does not take the display area of tobii5.screen_mm; set it with Tobii's "
	"software and leave tobii5.screen_mm at 0 0";

static void enter_tobii5_phase(struct gz_tobii5_session *session, enum gz_tobii5_phase phase,
			       int64_t due_ns)
{
	session->phase = phase;
	session->tries = 0;
	session->first_number = session->number + 1;
	session->due_ns = due_ns;
}

void gz_tobii5_session_begin(struct gz_tobii5_session *session, const struct gz_tobii5_area *wanted,
			     int64_t now_ns)
{
	*session = (struct gz_tobii5_session) { .has_wanted = wanted != NULL };
	if (wanted)
		session->wanted = *wanted;
	enter_tobii5_phase(session, GZ_TOBII5_GREETING, now_ns);
}

bool gz_tobii5_session_has_screen(const struct gz_tobii5_session *session)
{
	return session->has_area && gz_tobii5_area_is_screen(&session->area);
}

/* Go on with the area that there is. */
static void settle_tobii5_area(struct gz_tobii5_session *session, int64_t now_ns)
{
	session->trouble = NULL;
	if (!session->has_area)
		session->trouble = no_area;
	else if (session->has_wanted && !gz_tobii5_area_is_near(&session->area, &session->wanted))
		session->trouble = kept_area;
	else if (!gz_tobii5_area_is_screen(&session->area))
		session->trouble = lost_area;
	enter_tobii5_phase(session, GZ_TOBII5_SUBSCRIBING, now_ns);
}

/* What to do if the phase's request has been sent often enough. */
static void give_up_tobii5_phase(struct gz_tobii5_session *session, int64_t now_ns)
{
	switch (session->phase) {
	case GZ_TOBII5_GREETING:
		session->trouble = no_answer;
		return;
	case GZ_TOBII5_ASKING_AREA:
	case GZ_TOBII5_CHECKING_AREA:
		settle_tobii5_area(session, now_ns);
		return;
	case GZ_TOBII5_STREAMING:
		session->phase = GZ_TOBII5_SILENT;
		return;
	default:
		return;
	}
}

static int tries_of_tobii5_phase(enum gz_tobii5_phase phase)
{
	return phase == GZ_TOBII5_CHECKING_AREA ? GZ_TOBII5_TAKE_TRIES : GZ_TOBII5_TRIES;
}

static size_t print_tobii5_phase(struct gz_tobii5_session *session,
				 unsigned char bytes[GZ_TOBII5_REQUEST_MAX])
{
	session->number++;
	switch (session->phase) {
	case GZ_TOBII5_GREETING:
		return gz_tobii5_print_request(GZ_TOBII5_HELLO, session->number, NULL, bytes);
	case GZ_TOBII5_ASKING_AREA:
	case GZ_TOBII5_CHECKING_AREA:
		return gz_tobii5_print_request(GZ_TOBII5_GET_AREA, session->number, NULL, bytes);
	case GZ_TOBII5_SETTING_AREA:
		return gz_tobii5_print_request(GZ_TOBII5_SET_AREA, session->number,
					       &session->wanted, bytes);
	default:
		return gz_tobii5_print_request(GZ_TOBII5_SUBSCRIBE, session->number, NULL, bytes);
	}
}

/* A request that nothing answers is followed by the next phase. */
static void leave_unanswered_phase(struct gz_tobii5_session *session, int64_t now_ns)
{
	if (session->phase == GZ_TOBII5_SETTING_AREA)
		enter_tobii5_phase(session, GZ_TOBII5_CHECKING_AREA,
				   now_ns + GZ_TOBII5_TAKE_MS * GZ_NS_PER_MS);
	else if (session->phase == GZ_TOBII5_SUBSCRIBING)
		enter_tobii5_phase(session, GZ_TOBII5_STREAMING,
				   now_ns + GZ_TOBII5_ANSWER_MS * GZ_NS_PER_MS);
}

size_t gz_tobii5_session_ask(struct gz_tobii5_session *session, int64_t now_ns,
			     unsigned char bytes[GZ_TOBII5_REQUEST_MAX])
{
	if (now_ns < session->due_ns || session->phase == GZ_TOBII5_SILENT)
		return 0;
	if (session->tries >= tries_of_tobii5_phase(session->phase))
		give_up_tobii5_phase(session, now_ns);
	if (session->phase == GZ_TOBII5_SILENT)
		return 0;
	size_t size = print_tobii5_phase(session, bytes);
	session->tries++;
	session->due_ns = now_ns + GZ_TOBII5_ANSWER_MS * GZ_NS_PER_MS;
	leave_unanswered_phase(session, now_ns);
	return size;
}

static void take_tobii5_area(struct gz_tobii5_session *session, const struct gz_tobii5_frame *frame,
			     int64_t now_ns)
{
	bool is_check = session->phase == GZ_TOBII5_CHECKING_AREA;
	session->has_area =
		frame->size <= GZ_TOBII5_PAYLOAD_MAX &&
		gz_tobii5_parse_area(frame->payload, frame->size, &session->area) == GZ_OK;
	bool is_wanted =
		!session->has_wanted ||
		(session->has_area && gz_tobii5_area_is_near(&session->area, &session->wanted));
	if (is_wanted || (is_check && session->tries >= GZ_TOBII5_TAKE_TRIES))
		settle_tobii5_area(session, now_ns);
	else if (is_check)
		session->due_ns = now_ns + GZ_TOBII5_TAKE_MS * GZ_NS_PER_MS;
	else
		enter_tobii5_phase(session, GZ_TOBII5_SETTING_AREA, now_ns);
}

static void take_tobii5_answer(struct gz_tobii5_session *session,
			       const struct gz_tobii5_frame *frame, int64_t now_ns)
{
	uint32_t since = frame->number - session->first_number;
	if (since > session->number - session->first_number || session->tries == 0)
		return; /* to an earlier request */
	if (session->phase == GZ_TOBII5_GREETING) {
		session->trouble = NULL;
		enter_tobii5_phase(session, GZ_TOBII5_ASKING_AREA, now_ns);
	} else if (session->phase == GZ_TOBII5_ASKING_AREA ||
		   session->phase == GZ_TOBII5_CHECKING_AREA) {
		take_tobii5_area(session, frame, now_ns);
	}
}

enum gz_tobii5_news gz_tobii5_session_take(struct gz_tobii5_session *session,
					   const struct gz_tobii5_frame *frame, int64_t now_ns)
{
	if (frame->kind == GZ_TOBII5_RESPONSE) {
		take_tobii5_answer(session, frame, now_ns);
		return GZ_TOBII5_NEWS_NONE;
	}
	if (frame->kind != GZ_TOBII5_NOTIFICATION || frame->operation != GZ_TOBII5_GAZE)
		return GZ_TOBII5_NEWS_UNKNOWN;
	/* Of a subscription by an earlier program: the display area is not known yet. */
	if (session->phase != GZ_TOBII5_STREAMING)
		return GZ_TOBII5_NEWS_NONE;
	session->tries = 0;
	session->due_ns = now_ns + GZ_TOBII5_ANSWER_MS * GZ_NS_PER_MS;
	return GZ_TOBII5_NEWS_GAZE;
}
