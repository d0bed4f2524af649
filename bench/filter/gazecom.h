/**
 * @file
 * GazeCom: people who watch films, labelled by hand. Dorr, Martinetz, Gegenfurtner and Barth,
 * "Variability of eye movements when viewing dynamic natural scenes", Journal of Vision 10(10),
 * 2010; labels: Startsev, Agtzidis and Dorr, "1D CNN with BLSTM for automated classification of
 * fixations, saccades, and smooth pursuits", Behavior Research Methods 51, 2019.
 */
#ifndef GZ_BENCH_FILTER_GAZECOM_H
#define GZ_BENCH_FILTER_GAZECOM_H

#include "bench/filter/labelled_recording.h"

/** Films in the folder of recordings. */
#define GZ_GAZECOM_FILMS 6

/** Most people who watched one film. */
#define GZ_GAZECOM_OBSERVERS_MAX 64

/** Names of the films. */
extern const char *const gz_gazecom_films[GZ_GAZECOM_FILMS];

/** All recordings of one film, 250 Hz. */
struct gz_gazecom {
	size_t count;
	struct gz_labelled_recording recording[GZ_GAZECOM_OBSERVERS_MAX];
};

/**
 * Read the recordings of a film: GAZECAST_DATA/gaze/gazecom/FILM.tsv.gz. Its label "noise or blink"
 * is GZ_HUMAN_BLINK.
 *
 * @param data  the folder of data; NULL: there is none
 * @param film  place in gz_gazecom_films
 * @param[out] out  free with gz_gazecom_free(), in any case
 * @return false if it is missing or not such a file
 */
bool gz_gazecom_read(const char *data, size_t film, struct gz_gazecom *out);

/** Free what gz_gazecom_read() allocated. */
void gz_gazecom_free(struct gz_gazecom *gazecom);

#endif
