/* Calls into a library that ends the process where a file is not as it assumed. Inside the DICOM
 * reader. */
#ifndef GZ_RENDER_DECODE_DICOM_GUARD_HPP
#define GZ_RENDER_DECODE_DICOM_GUARD_HPP

#include <cstddef>
#include <cstdint>

namespace gz_dicom
{

/* No allocation by new in `call` may be larger than `most` bytes. */
bool run_guarded(bool (*call)(void *), void *user, size_t most);

/* Run `call`, which returns bool. False too if it throws (but std::bad_alloc goes on), or if an
 * assertion of a library fails in it: distributions build GDCM with them, and some check what a
 * file holds. What the call had allocated by then is lost, so this is for a process that ends soon.
 * `call` must hold no lock. Calls may be nested. */
template <typename F> bool guarded(F call)
{
	return run_guarded([](void *user) { return (bool)(*static_cast<F *>(user))(); }, &call,
			   SIZE_MAX);
}

/* Most bytes that reading a file of a size takes at once: the library takes memory for what an
 * element claims to hold before it reads it, and no element is larger than its file. */
size_t most_for_reading(uint64_t file_size);

/* As guarded(), and false too if `call`, or what it calls on this thread, wants more than `most`
 * bytes at once by new. */
template <typename F> bool guarded_within(size_t most, F call)
{
	return run_guarded([](void *user) { return (bool)(*static_cast<F *>(user))(); }, &call,
			   most);
}

} // namespace gz_dicom

#endif
