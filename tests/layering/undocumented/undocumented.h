/** Documented. */
int documented(int a,
	       int b);

int undocumented(int a);
