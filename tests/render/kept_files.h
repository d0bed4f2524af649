/* A cache folder of a test's own, below /tmp, for what is computed of meshes. */
#ifndef GZ_TESTS_RENDER_KEPT_FILES_H
#define GZ_TESTS_RENDER_KEPT_FILES_H

/* Make the folder and let XDG_CACHE_HOME name it. @return its path, until kept_files_close() */
const char *kept_files_open(void);

/* How many files of meshes it has. */
int kept_files_count(void);

/* Remove the folder and what it has. */
void kept_files_close(void);

#endif
