#include "render/decode/dicom/dicom_guard.hpp"

#include <cassert>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

namespace gz_dicom
{

namespace
{

/* Where the thread goes on when an assertion fails; NULL: the process ends. */
thread_local std::jmp_buf *assertion_exit = nullptr;

} // namespace

bool run_guarded(bool (*call)(void *), void *user)
{
	std::jmp_buf here;
	std::jmp_buf *const before = assertion_exit;
	volatile bool done = false;
	assertion_exit = &here;
	if (setjmp(here) == 0) {
		try {
			done = call(user);
		} catch (const std::bad_alloc &) {
			assertion_exit = before;
			throw;
		} catch (const std::exception &) {
			done = false;
		}
	} else {
		done = false;
	}
	assertion_exit = before;
	return done;
}

} // namespace gz_dicom

/* Stands in for the C library's (assert(3)), in the whole program that this is linked into. */
extern "C" void __assert_fail(const char *assertion, const char *file, unsigned int line,
			      const char *function) noexcept(true)
{
	(void)function;
	if (gz_dicom::assertion_exit)
		std::longjmp(*gz_dicom::assertion_exit, 1);
	(void)fprintf(stderr, "%s:%u: assertion failed: %s\n", file, line, assertion);
	abort();
}
