#include "daemon/accept.h"

#include <dlfcn.h>
#include <errno.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

int gz_accept4(int fd, struct sockaddr *address, socklen_t *size, int flags)
{
	int accepted = (int)syscall(SYS_accept4, fd, address, size, flags);
	if (accepted < 0 &&
	    (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM))
		errno = EAGAIN;
	return accepted;
}

int gz_accept(int fd, struct sockaddr *address, socklen_t *size)
{
	return gz_accept4(fd, address, size, 0);
}

bool gz_accept_is_found(void)
{
	int (*ours)(int, struct sockaddr *, socklen_t *, int) = gz_accept4;
	const void *found = dlsym(RTLD_DEFAULT, "accept4");
	return memcmp(&found, &ours, sizeof found) == 0;
}
