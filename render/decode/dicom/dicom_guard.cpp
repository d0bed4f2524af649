#include "render/decode/dicom/dicom_guard.hpp"

#include <algorithm>
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

/* Most bytes that new gives the thread at once, and whether more were wanted. */
thread_local size_t most_at_once = SIZE_MAX;
thread_local bool refused_more = false;

/* Lists grow in steps: items of a few bytes in the file take more in memory. Chosen. */
const uint64_t growth = 16, growth_most = 256 << 20, growth_least = 1 << 20;

} // namespace

size_t most_for_reading(uint64_t file_size)
{
	const uint64_t grown = std::min(file_size, growth_most / growth) * growth;
	return (size_t)(std::max(file_size, grown) + growth_least);
}

bool run_guarded(bool (*call)(void *), void *user, size_t most)
{
	std::jmp_buf here;
	std::jmp_buf *const before = assertion_exit;
	const size_t most_before = most_at_once;
	volatile bool done = false;
	assertion_exit = &here;
	most_at_once = std::min(most, most_before);
	refused_more = false;
	if (setjmp(here) == 0) {
		try {
			done = call(user);
		} catch (const std::bad_alloc &) {
			assertion_exit = before;
			most_at_once = most_before;
			if (!refused_more)
				throw;
			done = false;
		} catch (const std::exception &) {
			done = false;
		}
	} else {
		done = false;
	}
	assertion_exit = before;
	most_at_once = most_before;
	return done;
}

/* Memory as new gives it; NULL: there is none, or less is allowed. */
static void *take_memory(size_t size) noexcept
{
	refused_more = size > most_at_once;
	return refused_more ? nullptr : std::malloc(size > 0 ? size : 1);
}

static void *take_memory_or_throw(size_t size)
{
	void *memory = take_memory(size);
	if (!memory)
		throw std::bad_alloc();
	return memory;
}

} // namespace gz_dicom

/* These stand in for those of the C++ library in the whole program, also for the DICOM library. */
void *operator new(size_t size)
{
	return gz_dicom::take_memory_or_throw(size);
}

void *operator new[](size_t size)
{
	return gz_dicom::take_memory_or_throw(size);
}

void *operator new(size_t size, const std::nothrow_t &) noexcept
{
	return gz_dicom::take_memory(size);
}

void *operator new[](size_t size, const std::nothrow_t &) noexcept
{
	return gz_dicom::take_memory(size);
}

void operator delete(void *memory) noexcept
{
	std::free(memory);
}

void operator delete[](void *memory) noexcept
{
	std::free(memory);
}

void operator delete(void *memory, size_t) noexcept
{
	std::free(memory);
}

void operator delete[](void *memory, size_t) noexcept
{
	std::free(memory);
}

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
