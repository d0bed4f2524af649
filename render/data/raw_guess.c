#include "render/data/raw_guess.h"

#include <fcntl.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include "base/file.h"
#include "render/data/raw_name.h"

/* How much speaks for a guess: first where the dims come from, then the type. Chosen, so that what
 * a name says in full comes before what it says in part, and that before what only fits. */
enum {
	SCORE_TRIPLE_X = 100, /* 256x256x128 */
	SCORE_TRIPLE = 80,    /* 256_256_128 */
	SCORE_PAIR = 60,
	SCORE_CUBE_NAMED = 55,
	SCORE_SLICES_NAMED = 40,
	SCORE_CUBE = 25,
	SCORE_SLICES = 10,
	SCORE_TYPE_NAMED = 15,
	SCORE_TYPE_SIZED = 8,
	SCORE_TYPE_ANOTHER = -10,
};

/* Guesses in the making, best first. */
struct guesses {
	const struct gz_raw_name *name;
	uint64_t bytes;
	struct gz_raw_guess found[GZ_RAW_GUESSES_MAX];
	int scores[GZ_RAW_GUESSES_MAX];
	size_t count;
};

/* Dims and where they come from. */
struct shape {
	int dims[3];
	int score;
	int bits; /* of a voxel, where a number behind the dims says so; else 0 */
	const char *from;
};

static const int type_bytes[GZ_RAW_TYPE_COUNT] = {
	[GZ_RAW_UINT8] = 1,  [GZ_RAW_INT8] = 1,  [GZ_RAW_UINT16] = 2,  [GZ_RAW_INT16] = 2,
	[GZ_RAW_UINT32] = 4, [GZ_RAW_INT32] = 4, [GZ_RAW_FLOAT32] = 4, [GZ_RAW_FLOAT64] = 8,
};

uint64_t gz_raw_layout_bytes(const struct gz_raw_layout *layout)
{
	uint64_t bytes =
		(unsigned)layout->type < GZ_RAW_TYPE_COUNT ? (uint64_t)type_bytes[layout->type] : 0;
	for (int axis = 0; axis < 3; axis++) {
		const int edge = layout->dims[axis];
		bytes *= edge >= 1 && edge <= GZ_VOLUME_DIM_MAX ? (uint64_t)edge : 0;
	}
	return bytes;
}

static bool is_known(const struct guesses *guesses, const struct gz_raw_layout *layout)
{
	for (size_t i = 0; i < guesses->count; i++)
		if (memcmp(guesses->found[i].layout.dims, layout->dims, sizeof layout->dims) == 0 &&
		    guesses->found[i].layout.type == layout->type)
			return true;
	return false;
}

static void insert(struct guesses *guesses, const struct gz_raw_guess *guess, int score)
{
	size_t at = guesses->count;
	while (at > 0 && guesses->scores[at - 1] < score)
		at--;
	if (at == GZ_RAW_GUESSES_MAX || is_known(guesses, &guess->layout))
		return;
	if (guesses->count < GZ_RAW_GUESSES_MAX)
		guesses->count++;
	for (size_t i = guesses->count - 1; i > at; i--) {
		guesses->found[i] = guesses->found[i - 1];
		guesses->scores[i] = guesses->scores[i - 1];
	}
	guesses->found[at] = *guess;
	guesses->scores[at] = score;
}

/* What speaks for a type. */
struct type_reason {
	int type, score;
	bool is_named;
	const char *from;
};

static void add(struct guesses *guesses, const struct shape *shape, const struct type_reason *type)
{
	const struct gz_raw_name *name = guesses->name;
	struct gz_raw_guess guess = {
		.layout = { .type = (enum gz_raw_type)type->type,
			    .big_endian = name->big_endian && type_bytes[type->type] > 1 },
	};
	memcpy(guess.layout.dims, shape->dims, sizeof guess.layout.dims);
	memcpy(guess.layout.spacing, name->spacing, sizeof guess.layout.spacing);
	const uint64_t bytes = gz_raw_layout_bytes(&guess.layout);
	if (bytes == 0 || (guesses->bytes > 0 && bytes != guesses->bytes))
		return;
	guess.certain = guesses->bytes > 0 && shape->score >= SCORE_TRIPLE &&
			(type->is_named || type->type == GZ_RAW_UINT8);
	snprintf(guess.reason, sizeof guess.reason, "%s; %s%s", shape->from, type->from,
		 guesses->bytes > 0 ? "" : "; how many bytes there are is not known");
	insert(guesses, &guess, shape->score + type->score);
}

/* With each type that makes the size of @p shape that of the file. */
static void add_shape(struct guesses *guesses, const struct shape *shape)
{
	const struct gz_raw_name *name = guesses->name;
	int types[GZ_RAW_NAMED_TYPES];
	for (size_t i = 0; i < name->type_count; i++)
		add(guesses, shape,
		    &(struct type_reason) { name->types[i], SCORE_TYPE_NAMED - (int)i, i == 0,
					    "the name tells the type" });
	if (shape->bits && name->type_count == 0) {
		const size_t count = gz_raw_types_of_bits(shape->bits, types);
		for (size_t i = 0; i < count; i++)
			add(guesses, shape,
			    &(struct type_reason) { types[i], SCORE_TYPE_NAMED - (int)i, i == 0,
						    "the name tells the bits of a voxel" });
	}
	if (guesses->bytes == 0)
		return;
	for (int bits = 8; bits <= 64; bits *= 2) {
		const size_t count = gz_raw_types_of_bits(bits, types);
		const bool another = name->type_count > 0;
		for (size_t i = 0; i < count; i++)
			add(guesses, shape,
			    &(struct type_reason) {
				    types[i],
				    (another ? SCORE_TYPE_ANOTHER : SCORE_TYPE_SIZED) - (int)i,
				    false,
				    another ? "not the type that the name tells, whose size would "
					      "be another"
					    : "the size tells the bytes of a voxel" });
	}
}

static bool is_edge(const struct gz_raw_number *number)
{
	return number->is_whole && number->value >= 1 && number->value <= GZ_VOLUME_DIM_MAX;
}

/* Three joined numbers. */
static void add_triples(struct guesses *guesses)
{
	const struct gz_raw_name *name = guesses->name;
	for (size_t i = 0; i + 2 < name->number_count; i++) {
		const struct gz_raw_number *n = &name->numbers[i];
		const bool by_x = n[0].joint == 'x' || n[0].joint == '*';
		if (!n[0].joint || n[0].joint != n[1].joint || !is_edge(&n[0]) || !is_edge(&n[1]) ||
		    !is_edge(&n[2]) || n[1].is_glued || n[2].is_glued || (n[0].is_glued && !by_x))
			continue;
		struct shape shape = {
			.dims = { (int)n[0].value, (int)n[1].value, (int)n[2].value },
			.score = by_x ? SCORE_TRIPLE_X : SCORE_TRIPLE,
			.from = "the name tells the voxels along x, y, z",
		};
		if (n[2].joint && i + 3 < name->number_count && is_edge(&n[3]))
			shape.bits = (int)n[3].value;
		add_shape(guesses, &shape);
	}
}

/* Slices of a known size, as many as there are bytes for. */
static void add_slices(struct guesses *guesses, int width, int height, struct shape shape,
		       int least, int most)
{
	for (int bytes = 1; bytes <= 8; bytes *= 2) {
		const uint64_t slice = (uint64_t)width * (uint64_t)height * (uint64_t)bytes;
		const uint64_t count = guesses->bytes / slice;
		if (guesses->bytes % slice != 0 || count < (uint64_t)least ||
		    count > (uint64_t)most)
			continue;
		shape.dims[0] = width;
		shape.dims[1] = height;
		shape.dims[2] = (int)count;
		add_shape(guesses, &shape);
	}
}

static void add_pairs(struct guesses *guesses)
{
	const struct gz_raw_name *name = guesses->name;
	const struct shape shape = {
		.score = SCORE_PAIR,
		.from = "the name tells the voxels along x and y, the size those along z",
	};
	for (size_t i = 0; i + 1 < name->number_count; i++) {
		const struct gz_raw_number *n = &name->numbers[i];
		if (n[0].joint == 'x' && is_edge(&n[0]) && is_edge(&n[1]) && !n[1].is_glued)
			add_slices(guesses, (int)n[0].value, (int)n[1].value, shape, 2,
				   GZ_VOLUME_DIM_MAX);
	}
}

/* The edge of the cube that has so many voxels; 0 where there is none. */
static int cube_edge(uint64_t voxels)
{
	const int edge = (int)lround(cbrt((double)voxels));
	return edge > 0 && edge <= GZ_VOLUME_DIM_MAX &&
			       (uint64_t)edge * (uint64_t)edge * (uint64_t)edge == voxels
		       ? edge
		       : 0;
}

/* One number: "bonsai256". Least edge chosen: smaller numbers count something else. */
static void add_singles(struct guesses *guesses)
{
	enum { EDGE_LEAST = 16 };
	const struct gz_raw_name *name = guesses->name;
	for (size_t i = 0; i < name->number_count; i++) {
		const struct gz_raw_number *n = &name->numbers[i];
		const int edge = is_edge(n) && n->value >= EDGE_LEAST ? (int)n->value : 0;
		if (!edge)
			continue;
		const struct shape cube = {
			.dims = { edge, edge, edge },
			.score = SCORE_CUBE_NAMED,
			.from = "a cube whose edge the name tells",
		};
		const struct shape slices = {
			.score = SCORE_SLICES_NAMED,
			.from = "square slices whose edge the name tells",
		};
		add_shape(guesses, &cube);
		add_slices(guesses, edge, edge, slices, 2, 4 * edge);
	}
}

/* Nothing but the size. Edges of slices: those of scanners and of published volumes. */
static void add_by_size(struct guesses *guesses)
{
	static const int edges[] = { 512, 256, 1024, 128, 2048, 64, 768, 320, 384, 192 };
	for (int bytes = 1; bytes <= 8; bytes *= 2) {
		const int edge = guesses->bytes % (uint64_t)bytes == 0
					 ? cube_edge(guesses->bytes / (uint64_t)bytes)
					 : 0;
		const struct shape cube = {
			.dims = { edge, edge, edge },
			.score = SCORE_CUBE,
			.from = "the size is that of a cube",
		};
		if (edge > 1)
			add_shape(guesses, &cube);
	}
	for (size_t i = 0; i < sizeof edges / sizeof edges[0]; i++) {
		const struct shape slices = {
			.score = SCORE_SLICES - (int)i,
			.from = "the size is that of square slices",
		};
		add_slices(guesses, edges[i], edges[i], slices, edges[i] / 8, 2 * edges[i]);
	}
}

size_t gz_raw_guess(const char *name, uint64_t bytes, struct gz_raw_guess *out_guesses, size_t room)
{
	struct gz_raw_name read;
	struct guesses guesses = { .name = &read, .bytes = bytes };
	gz_raw_name_read(name, &read);
	add_triples(&guesses);
	if (bytes > 0) {
		add_pairs(&guesses);
		add_singles(&guesses);
		add_by_size(&guesses);
	}
	const size_t count = guesses.count < room ? guesses.count : room;
	memcpy(out_guesses, guesses.found, count * sizeof guesses.found[0]);
	return count;
}

/* As the first frame says; frames of nothing, as parallel compressors put first, say 0. */
static uint64_t zstd_bytes(int fd)
{
	unsigned char head[32];
	const ssize_t got = pread(fd, head, sizeof head, 0);
	if (got <= 0)
		return 0;
	const unsigned long long told = ZSTD_getFrameContentSize(head, (size_t)got);
	return told == ZSTD_CONTENTSIZE_UNKNOWN || told == ZSTD_CONTENTSIZE_ERROR ? 0 : told;
}

/* The last four bytes are the size modulo 2^32 (RFC 1952, section 2.3.1), of the last member. It
 * is told where it can be the size of all: not much less than what it was compressed to. */
static uint64_t gzip_bytes(int fd, uint64_t size)
{
	unsigned char tail[4];
	if (size < 18 || pread(fd, tail, sizeof tail, (off_t)(size - 4)) != (ssize_t)sizeof tail)
		return 0;
	const uint64_t told = (uint64_t)tail[0] | (uint64_t)tail[1] << 8 | (uint64_t)tail[2] << 16 |
			      (uint64_t)tail[3] << 24;
	return told + told / 100 + 64 >= size ? told : 0;
}

uint64_t gz_raw_file_bytes(const char *path)
{
	struct stat status;
	const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	uint64_t bytes = 0;
	if (fd < 0)
		return 0;
	if (fstat(fd, &status) == 0 && S_ISREG(status.st_mode)) {
		bytes = (uint64_t)status.st_size;
		if (gz_path_ends(path, ".zst"))
			bytes = zstd_bytes(fd);
		else if (gz_path_ends(path, ".gz"))
			bytes = gzip_bytes(fd, bytes);
	}
	close(fd);
	return bytes;
}

bool gz_raw_is_name(const char *path)
{
	static const char *const endings[] = {
		".raw", ".zst", ".gz", ".bin", ".dat", ".vol", ".img"
	};
	for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++)
		if (gz_path_ends(path, endings[i]) && !gz_path_ends(path, ".nii.gz"))
			return true;
	return false;
}
