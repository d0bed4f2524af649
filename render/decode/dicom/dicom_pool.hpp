/* Threads that decode the slices of a stack, a few ahead of who takes them in order. Inside the
 * DICOM reader. */
#ifndef GZ_RENDER_DECODE_DICOM_POOL_HPP
#define GZ_RENDER_DECODE_DICOM_POOL_HPP

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/result.h"

namespace gz_dicom
{

/* A decoded slice, or why there is none. */
struct decoded_slice {
	gz_result result = GZ_OK;
	std::string why;
	bool overlap = false; /* of segments */
	std::vector<uint8_t> voxels;
};

class slice_pool
{
      public:
	/* Decodes slice number `index`; called by several threads at once. */
	using decoder = std::function<decoded_slice(size_t index)>;

	/* `bytes`: memory that decoding one slice takes, which limits the threads. */
	slice_pool(size_t count, uint64_t bytes, decoder decode);
	~slice_pool();
	slice_pool(const slice_pool &) = delete;
	slice_pool &operator=(const slice_pool &) = delete;

	/* The next slice, in order; waits for it. At most `count` times. */
	decoded_slice take();

      private:
	void work();
	bool claim(size_t &out_index);

	const size_t count;
	const decoder decode;
	std::vector<decoded_slice> ahead; /* slice i is in i % size */
	std::vector<bool> ready;
	size_t claimed = 0, taken = 0;
	bool stopping = false;
	std::mutex mutex;
	std::condition_variable room, made;
	std::vector<std::thread> threads;
};

} // namespace gz_dicom

#endif
