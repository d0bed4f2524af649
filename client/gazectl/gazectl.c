/* gazectl: the command line of the daemon. main() and the list of commands. */
#include "client/gazectl/gazectl.h"

static const struct gz_command *const commands[] = {
	&gazectl_devices, &gazectl_status,  &gazectl_watch, &gazectl_record,
	&gazectl_stop,    &gazectl_inspect, &gazectl_label, &gazectl_validate,
	&gazectl_keygen,  &gazectl_convert, NULL,
};

int main(int argc, char **argv)
{
	const struct gz_command_program program = {
		.name = "gazectl",
		.version = GAZECAST_VERSION,
		.purpose = "Show the state of the gaze daemon and its stream, check the tracker, "
			   "make recordings, inspect, label and convert them.",
		.exits = "0 done, 1 failed or refused, 2 usage, 3 no daemon answers, "
			 "4 the log is cut or corrupted, 5 the check was cancelled",
		.commands = commands,
	};
	return gz_command_main(&program, argc, argv);
}
