/* Calls into a library that ends the process where a file is not as it assumed. Inside the DICOM
 * reader. */
#ifndef GZ_RENDER_DECODE_DICOM_GUARD_HPP
#define GZ_RENDER_DECODE_DICOM_GUARD_HPP

namespace gz_dicom
{

bool run_guarded(bool (*call)(void *), void *user);

/* Run `call`, which returns bool. False too if it throws (but std::bad_alloc goes on), or if an
 * assertion of a library fails in it: distributions build GDCM with them, and some check what a
 * file holds. What the call had allocated by then is lost, so this is for a process that ends soon.
 * `call` must hold no lock. Calls may be nested. */
template <typename F> bool guarded(F call)
{
	return run_guarded([](void *user) { return (bool)(*static_cast<F *>(user))(); }, &call);
}

} // namespace gz_dicom

#endif
