/* The name of a raw file first, then the layouts that it and the size allow. */
#include "render/data/raw_guess.h"

#include <ctype.h>
#include <fcntl.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zstd.h>

#include "base/file.h"
#include "render/data/volume_import.h"

enum { NAME_SIZE = 256, NUMBERS_MAX = 24, NAMED_TYPES = 3 };

/* A number in a name. */
struct raw_number {
	double value;
	bool is_whole; /* no decimals */
	bool is_glued; /* part of a word, as the 16 of "uint16" */
	char joint;    /* the one character between it and the next number; 0: there is more */
};

/* A name, understood. */
struct raw_name {
	char text[NAME_SIZE]; /* lower case, without folder and endings */
	struct raw_number numbers[NUMBERS_MAX];
	size_t number_count;
	int types[NAMED_TYPES]; /* enum gz_raw_type, the likeliest first */
	size_t type_count;      /* 0: none is named */
	const char *type_word;  /* how it is named; static */
	bool big_endian;
	double spacing[3]; /* 1 where none is named */
	bool has_spacing;
};

/* Words for types; longer ones before those that they begin with. -1 ends a row. */
static const struct {
	const char *word;
	int types[NAMED_TYPES];
} type_words[] = {
	{ "unsigned_char", { GZ_RAW_UINT8, -1 } },
	{ "unsigned_short", { GZ_RAW_UINT16, -1 } },
	{ "unsigned_int", { GZ_RAW_UINT32, -1 } },
	{ "uint8", { GZ_RAW_UINT8, -1 } },
	{ "uint16", { GZ_RAW_UINT16, -1 } },
	{ "uint32", { GZ_RAW_UINT32, -1 } },
	{ "float32", { GZ_RAW_FLOAT32, -1 } },
	{ "float64", { GZ_RAW_FLOAT64, -1 } },
	{ "double", { GZ_RAW_FLOAT64, -1 } },
	{ "float", { GZ_RAW_FLOAT32, -1 } },
	{ "ushort", { GZ_RAW_UINT16, -1 } },
	{ "uchar", { GZ_RAW_UINT8, -1 } },
	{ "ubyte", { GZ_RAW_UINT8, -1 } },
	{ "schar", { GZ_RAW_INT8, -1 } },
	{ "sbyte", { GZ_RAW_INT8, -1 } },
	{ "short", { GZ_RAW_INT16, -1 } },
	{ "byte", { GZ_RAW_UINT8, -1 } },
	{ "char", { GZ_RAW_UINT8, GZ_RAW_INT8, -1 } },
	{ "int8", { GZ_RAW_INT8, -1 } },
	{ "int16", { GZ_RAW_INT16, -1 } },
	{ "int32", { GZ_RAW_INT32, -1 } },
	{ "uint", { GZ_RAW_UINT32, -1 } },
	{ "int", { GZ_RAW_INT32, -1 } },
	{ "u8", { GZ_RAW_UINT8, -1 } },
	{ "u16", { GZ_RAW_UINT16, -1 } },
	{ "u32", { GZ_RAW_UINT32, -1 } },
	{ "i8", { GZ_RAW_INT8, -1 } },
	{ "i16", { GZ_RAW_INT16, -1 } },
	{ "i32", { GZ_RAW_INT32, -1 } },
	{ "s8", { GZ_RAW_INT8, -1 } },
	{ "s16", { GZ_RAW_INT16, -1 } },
	{ "s32", { GZ_RAW_INT32, -1 } },
	{ "f32", { GZ_RAW_FLOAT32, -1 } },
	{ "f64", { GZ_RAW_FLOAT64, -1 } },
	{ "8ubit", { GZ_RAW_UINT8, -1 } },
	{ "8bit", { GZ_RAW_UINT8, GZ_RAW_INT8, -1 } },
	{ "16bit", { GZ_RAW_UINT16, GZ_RAW_INT16, -1 } },
	{ "32bit", { GZ_RAW_FLOAT32, GZ_RAW_INT32, GZ_RAW_UINT32 } },
	{ "64bit", { GZ_RAW_FLOAT64, -1 } },
	{ "8u", { GZ_RAW_UINT8, -1 } },
	{ "16u", { GZ_RAW_UINT16, -1 } },
	{ "8s", { GZ_RAW_INT8, -1 } },
	{ "16s", { GZ_RAW_INT16, -1 } },
	{ "32f", { GZ_RAW_FLOAT32, -1 } },
	{ "64f", { GZ_RAW_FLOAT64, -1 } },
};

/* Words for byte orders; the first that stands by itself, or behind a type, counts. */
static const struct {
	const char *word;
	bool is_big;
} order_words[] = {
	{ "bigendian", true }, { "littleendian", false }, { "big", true }, { "little", false },
	{ "msb", true },       { "lsb", false },          { "be", true },  { "le", false },
};

static const char *const endings[] = { ".zst", ".gz", ".raw", ".bin", ".dat", ".vol", ".img" };

static bool is_word(char c)
{
	return isalnum((unsigned char)c) != 0;
}

/* The name without folder and endings, in lower case; the sign of multiplication becomes an x. */
static void take_name_text(const char *path, char out_text[NAME_SIZE])
{
	const char *slash = strrchr(path, '/');
	const char *from = slash ? slash + 1 : path;
	size_t used = 0;
	for (; *from && used + 1 < NAME_SIZE; from++) {
		if (strncmp(from, "\xc3\x97", 2) == 0) {
			out_text[used++] = 'x';
			from++;
			continue;
		}
		out_text[used++] = (char)tolower((unsigned char)*from);
	}
	out_text[used] = '\0';
	for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
		const size_t length = strlen(endings[i]);
		if (used > length && strcmp(out_text + used - length, endings[i]) == 0) {
			used -= length;
			out_text[used] = '\0';
		}
	}
}

/* Where a number that begins here ends. A dot belongs to it where one fraction follows: several
 * dots join whole numbers. */
static size_t number_end(const char *text, size_t at, bool *out_whole)
{
	size_t end = at;
	*out_whole = true;
	while (isdigit((unsigned char)text[end]))
		end++;
	const bool joined = at > 1 && text[at - 1] == '.' && isdigit((unsigned char)text[at - 2]);
	if (text[end] != '.' || !isdigit((unsigned char)text[end + 1]) || joined)
		return end;
	size_t after = end + 1;
	while (isdigit((unsigned char)text[after]))
		after++;
	if (text[after] == '.' && isdigit((unsigned char)text[after + 1]))
		return end;
	*out_whole = false;
	return after;
}

/* Whether a number is part of a word: behind a letter that is no x between two numbers, or before
 * one that belongs to a type, as in "16bit". */
static bool is_glued(const char *text, size_t start, size_t end)
{
	const bool joined =
		start > 1 && text[start - 1] == 'x' && isdigit((unsigned char)text[start - 2]);
	if (start > 0 && isalpha((unsigned char)text[start - 1]) && !joined)
		return true;
	return isalpha((unsigned char)text[end]) && text[end] != 'x' &&
	       strncmp(text + end, "mm", 2) != 0;
}

static void take_numbers_of_name(struct raw_name *name)
{
	const char *text = name->text;
	for (size_t at = 0; text[at] && name->number_count < NUMBERS_MAX;) {
		if (!isdigit((unsigned char)text[at])) {
			at++;
			continue;
		}
		struct raw_number *number = &name->numbers[name->number_count++];
		const size_t end = number_end(text, at, &number->is_whole);
		char copy[NAME_SIZE];
		snprintf(copy, sizeof copy, "%.*s", (int)(end - at), text + at);
		number->value = strtod(copy, NULL);
		number->is_glued = is_glued(text, at, end);
		const char joint = text[end];
		number->joint =
			joint && strchr("x_-.,*", joint) && isdigit((unsigned char)text[end + 1])
				? joint
				: '\0';
		at = end;
	}
}

/* Whether a word stands at a place by itself: no letter before it, nor digit but behind a number's
 * own letters, and behind it the end, a byte order or something that is no letter. */
static bool stands_alone(const char *text, size_t at, size_t length)
{
	const char first = text[at], before = at > 0 ? text[at - 1] : '\0';
	if (isalpha((unsigned char)before) && before != 'x')
		return false;
	if (isdigit((unsigned char)first) && isdigit((unsigned char)before))
		return false;
	const char *after = text + at + length;
	if (!is_word(*after))
		return true;
	if (*after == 's' && !is_word(after[1])) /* bits, bytes */
		return true;
	for (size_t i = 0; i < sizeof order_words / sizeof order_words[0]; i++) {
		const size_t word = strlen(order_words[i].word);
		if (strncmp(after, order_words[i].word, word) == 0 && !is_word(after[word]))
			return true;
	}
	return false;
}

static bool name_has_word(const char *text, const char *word)
{
	for (const char *at = strstr(text, word); at; at = strstr(at + 1, word))
		if (stands_alone(text, (size_t)(at - text), strlen(word)))
			return true;
	return false;
}

static void take_name_type(struct raw_name *name)
{
	for (size_t i = 0; i < sizeof type_words / sizeof type_words[0]; i++) {
		if (!name_has_word(name->text, type_words[i].word))
			continue;
		name->type_word = type_words[i].word;
		for (size_t k = 0; k < NAMED_TYPES && type_words[i].types[k] >= 0; k++)
			name->types[name->type_count++] = type_words[i].types[k];
		return;
	}
}

/* An order stands by itself, or right behind a type: "int16be". */
static bool name_has_order(const char *text, const char *word)
{
	const size_t length = strlen(word);
	for (const char *at = strstr(text, word); at; at = strstr(at + 1, word)) {
		const char before = at > text ? at[-1] : '\0';
		const bool behind_type = isdigit((unsigned char)before) ||
					 (at - text >= 5 && strncmp(at - 5, "short", 5) == 0) ||
					 (at - text >= 5 && strncmp(at - 5, "float", 5) == 0);
		if ((!is_word(before) || behind_type) && !is_word(at[length]))
			return true;
	}
	return false;
}

static void take_name_order(struct raw_name *name)
{
	for (size_t i = 0; i < sizeof order_words / sizeof order_words[0]; i++)
		if (name_has_order(name->text, order_words[i].word)) {
			name->big_endian = order_words[i].is_big;
			return;
		}
}

static bool are_joined(const struct raw_number *numbers)
{
	return numbers[0].joint && numbers[0].joint == numbers[1].joint;
}

/* Three joined numbers of which one has decimals, or that follow three whole ones joined by x; else
 * one with decimals before "mm". */
static void take_name_spacing(struct raw_name *name)
{
	size_t triples = 0;
	for (size_t i = 0; i + 2 < name->number_count; i++) {
		const struct raw_number *n = &name->numbers[i];
		if (!are_joined(n))
			continue;
		const bool whole = n[0].is_whole && n[1].is_whole && n[2].is_whole;
		if (whole && (triples++ == 0 || n[0].joint != 'x')) {
			i += n[0].joint == 'x' ? 2 : 0;
			continue;
		}
		if (!(n[0].value > 0 && n[1].value > 0 && n[2].value > 0))
			continue;
		for (int axis = 0; axis < 3; axis++)
			name->spacing[axis] = n[axis].value;
		name->has_spacing = true;
		return;
	}
	const char *unit = strstr(name->text, "mm");
	if (!unit || unit == name->text || !isdigit((unsigned char)unit[-1]) || is_word(unit[2]))
		return;
	const char *start = unit;
	while (start > name->text && (isdigit((unsigned char)start[-1]) || start[-1] == '.'))
		start--;
	const double edge = strtod(start, NULL);
	if (!(edge > 0))
		return;
	name->spacing[0] = name->spacing[1] = name->spacing[2] = edge;
	name->has_spacing = true;
}

static void read_raw_name(const char *path, struct raw_name *out_name)
{
	*out_name = (struct raw_name) { .spacing = { 1, 1, 1 } };
	take_name_text(path, out_name->text);
	take_numbers_of_name(out_name);
	take_name_type(out_name);
	take_name_order(out_name);
	take_name_spacing(out_name);
}

static size_t types_of_bits(int bits, int out_types[NAMED_TYPES])
{
	static const struct {
		int bits, types[NAMED_TYPES];
	} rows[] = {
		{ 8, { GZ_RAW_UINT8, GZ_RAW_INT8, -1 } },
		{ 16, { GZ_RAW_UINT16, GZ_RAW_INT16, -1 } },
		{ 32, { GZ_RAW_FLOAT32, GZ_RAW_INT32, GZ_RAW_UINT32 } },
		{ 64, { GZ_RAW_FLOAT64, -1, -1 } },
	};
	size_t count = 0;
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
		for (size_t k = 0; k < NAMED_TYPES; k++)
			if (rows[i].bits == bits && rows[i].types[k] >= 0)
				out_types[count++] = rows[i].types[k];
	return count;
}

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
	const struct raw_name *name;
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

uint64_t gz_raw_layout_bytes(const struct gz_raw_layout *layout)
{
	const int channels = layout->channels == 0 ? 1 : layout->channels;
	const bool known = channels == 1 || channels == 3 || channels == 4;
	uint64_t bytes = known && (unsigned)layout->type < GZ_RAW_TYPE_COUNT
				 ? (uint64_t)channels * gz_raw_type_size(layout->type)
				 : 0;
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

static void insert_guess(struct guesses *guesses, const struct gz_raw_guess *guess, int score)
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

static void add_guess(struct guesses *guesses, const struct shape *shape,
		      const struct type_reason *type)
{
	const struct raw_name *name = guesses->name;
	struct gz_raw_guess guess = {
		.layout = { .type = (enum gz_raw_type)type->type,
			    .big_endian = name->big_endian && gz_raw_type_size(type->type) > 1 },
	};
	memcpy(guess.layout.dims, shape->dims, sizeof guess.layout.dims);
	if (name->has_spacing)
		memcpy(guess.layout.spacing, name->spacing, sizeof guess.layout.spacing);
	const uint64_t bytes = gz_raw_layout_bytes(&guess.layout);
	if (bytes == 0 || (guesses->bytes > 0 && bytes != guesses->bytes))
		return;
	guess.certain = guesses->bytes > 0 && shape->score >= SCORE_TRIPLE &&
			(type->is_named || type->type == GZ_RAW_UINT8);
	snprintf(guess.reason, sizeof guess.reason, "%s; %s%s", shape->from, type->from,
		 guesses->bytes > 0 ? "" : "; how many bytes there are is not known");
	insert_guess(guesses, &guess, shape->score + type->score);
}

/* With each type that makes the size of @p shape that of the file. */
static void add_shape(struct guesses *guesses, const struct shape *shape)
{
	const struct raw_name *name = guesses->name;
	int types[NAMED_TYPES];
	for (size_t i = 0; i < name->type_count; i++)
		add_guess(guesses, shape,
			  &(struct type_reason) { name->types[i], SCORE_TYPE_NAMED - (int)i, i == 0,
						  "the name tells the type" });
	if (shape->bits && name->type_count == 0) {
		const size_t count = types_of_bits(shape->bits, types);
		for (size_t i = 0; i < count; i++)
			add_guess(guesses, shape,
				  &(struct type_reason) { types[i], SCORE_TYPE_NAMED - (int)i,
							  i == 0,
							  "the name tells the bits of a voxel" });
	}
	if (guesses->bytes == 0)
		return;
	for (int bits = 8; bits <= 64; bits *= 2) {
		const size_t count = types_of_bits(bits, types);
		const bool another = name->type_count > 0;
		for (size_t i = 0; i < count; i++)
			add_guess(
				guesses, shape,
				&(struct type_reason) {
					types[i],
					(another ? SCORE_TYPE_ANOTHER : SCORE_TYPE_SIZED) - (int)i,
					false,
					another ? "not the type that the name tells, whose size "
						  "would "
						  "be another"
						: "the size tells the bytes of a voxel" });
	}
}

static bool can_be_edge(const struct raw_number *number)
{
	return number->is_whole && number->value >= 1 && number->value <= GZ_VOLUME_DIM_MAX;
}

/* Three joined numbers. */
static void add_triples(struct guesses *guesses)
{
	const struct raw_name *name = guesses->name;
	for (size_t i = 0; i + 2 < name->number_count; i++) {
		const struct raw_number *n = &name->numbers[i];
		const bool by_x = n[0].joint == 'x' || n[0].joint == '*';
		if (!n[0].joint || n[0].joint != n[1].joint || !can_be_edge(&n[0]) ||
		    !can_be_edge(&n[1]) || !can_be_edge(&n[2]) || n[1].is_glued || n[2].is_glued ||
		    (n[0].is_glued && !by_x))
			continue;
		struct shape shape = {
			.dims = { (int)n[0].value, (int)n[1].value, (int)n[2].value },
			.score = by_x ? SCORE_TRIPLE_X : SCORE_TRIPLE,
			.from = "the name tells the voxels along x, y, z",
		};
		if (n[2].joint && i + 3 < name->number_count && can_be_edge(&n[3]))
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
	const struct raw_name *name = guesses->name;
	const struct shape shape = {
		.score = SCORE_PAIR,
		.from = "the name tells the voxels along x and y, the size those along z",
	};
	for (size_t i = 0; i + 1 < name->number_count; i++) {
		const struct raw_number *n = &name->numbers[i];
		if (n[0].joint == 'x' && can_be_edge(&n[0]) && can_be_edge(&n[1]) && !n[1].is_glued)
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
	const struct raw_name *name = guesses->name;
	for (size_t i = 0; i < name->number_count; i++) {
		const struct raw_number *n = &name->numbers[i];
		const int edge = can_be_edge(n) && n->value >= EDGE_LEAST ? (int)n->value : 0;
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
	struct raw_name read;
	struct guesses guesses = { .name = &read, .bytes = bytes };
	read_raw_name(name, &read);
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

bool gz_raw_name_contradicts(const char *name, uint64_t bytes, struct gz_raw_layout *out_layout)
{
	struct gz_raw_guess named = { 0 };
	if (bytes == 0 || gz_raw_guess(name, 0, &named, 1) == 0 ||
	    gz_raw_layout_bytes(&named.layout) == bytes)
		return false;
	*out_layout = named.layout;
	return true;
}
