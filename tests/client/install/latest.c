#include <gazecast.h>
#include <stdio.h>

int main(int argc, char **argv)
{
	struct gz_client *client;
	struct gz_gaze gaze;
	int64_t age_ns;
	if (gz_client_open(argc > 1 ? argv[1] : NULL, NULL, &client) != GZ_OK)
		return 1;
	while (gz_client_latest(client, &gaze, &age_ns) != GZ_OK)
		gz_clock_sleep_until_ns(gz_clock_now_ns() + GZ_NS_PER_MS);
	printf("%.3f %.3f, %.1f ms ago\n", (double)gaze.point.x, (double)gaze.point.y,
	       gz_ns_to_ms(age_ns));
	gz_client_close(&client);
}
