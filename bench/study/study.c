#include "bench/study/study.h"

#include <stdlib.h>

void gz_study_free(struct gz_study *study)
{
	free(study->scenes);
	free(study->variants);
	free(study->sizes);
	free(study->backends);
	free(study->points);
	free(study->bound_rays);
	free(study->rows);
	*study = (struct gz_study) { 0 };
}
