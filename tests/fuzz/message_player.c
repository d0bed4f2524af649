/* A decoder that sends the bytes of the file that it is to decode as its messages. */
#include <fcntl.h>
#include <stdint.h>
#include <unistd.h>

#include "render/decode/decode_protocol.h"

int main(int argc, char **argv)
{
	uint8_t bytes[sizeof(struct gz_decode_message)];
	const int file = argc > 3 ? open(argv[3], O_RDONLY | O_CLOEXEC) : -1;
	for (ssize_t got; (got = read(file, bytes, sizeof bytes)) > 0;)
		if (write(GZ_DECODE_FD_MESSAGES, bytes, (size_t)got) != got)
			return 1;
	return 0;
}
