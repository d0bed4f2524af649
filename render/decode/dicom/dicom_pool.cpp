#include "render/decode/dicom/dicom_pool.hpp"

#include <algorithm>
#include <exception>
#include <new>
#include <sched.h>
#include <utility>

namespace gz_dicom
{

namespace
{

/* Most threads, and the memory that their slices may take together. Chosen: far below the limit of
 * the process with its stacks and heaps. */
const size_t threads_max = 8;
const uint64_t memory_max = (uint64_t)1 << 30;

/* Slices in flight for each thread (chosen: one is made while another waits). */
const size_t ahead_per_thread = 2;

size_t processors()
{
	cpu_set_t set;
	const int count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
	return count > 1 ? (size_t)count : 1;
}

decoded_slice decode_or_explain(const slice_pool::decoder &decode, size_t index)
{
	decoded_slice slice;
	try {
		return decode(index);
	} catch (const std::bad_alloc &) {
		slice.result = GZ_ERR_NO_MEM;
		slice.why = "no memory to decode it";
	} catch (const std::exception &e) {
		slice.result = GZ_ERR_FORMAT;
		slice.why = std::string("cannot be decoded: ") + e.what();
	}
	return slice;
}

} // namespace

slice_pool::slice_pool(size_t slices, uint64_t bytes, decoder with)
    : count(slices), decode(std::move(with))
{
	const size_t affordable =
		(size_t)std::max<uint64_t>(1, memory_max / (std::max<uint64_t>(1, bytes)));
	const size_t wanted = std::min({ processors(), threads_max, affordable, count });
	ahead.resize(wanted * ahead_per_thread);
	ready.resize(ahead.size());
	for (size_t i = 0; i < wanted; i++)
		threads.emplace_back([this] { work(); });
}

slice_pool::~slice_pool()
{
	{
		const std::lock_guard<std::mutex> lock(mutex);
		stopping = true;
	}
	room.notify_all();
	for (std::thread &thread : threads)
		thread.join();
}

bool slice_pool::claim(size_t &out_index)
{
	std::unique_lock<std::mutex> lock(mutex);
	room.wait(lock, [this] {
		return stopping || claimed == count || claimed < taken + ahead.size();
	});
	if (stopping || claimed == count)
		return false;
	out_index = claimed++;
	return true;
}

void slice_pool::work()
{
	for (size_t index; claim(index);) {
		decoded_slice slice = decode_or_explain(decode, index);
		const std::lock_guard<std::mutex> lock(mutex);
		ahead[index % ahead.size()] = std::move(slice);
		ready[index % ahead.size()] = true;
		made.notify_one();
	}
}

decoded_slice slice_pool::take()
{
	std::unique_lock<std::mutex> lock(mutex);
	const size_t at = taken % ahead.size();
	made.wait(lock, [this, at] { return (bool)ready[at]; });
	decoded_slice slice = std::move(ahead[at]);
	ready[at] = false;
	taken++;
	room.notify_all();
	return slice;
}

} // namespace gz_dicom
