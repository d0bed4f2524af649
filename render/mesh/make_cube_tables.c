/*
 * Writes the tables of marching cubes as C to the file it is given; the build runs it.
 *
 * Everything follows from the shape of the cube. Corner c lies at x = c & 1, y = c >> 1 & 1,
 * z = c >> 2. Edge 4 * axis + u + 2 * v runs along the axis; u and v are its place on the other two
 * axes, the lower one first. A set of corners is a byte; those in it are above the isovalue, here
 * called full.
 *
 * On each face, every run of full corners is cut off by a segment from the edge where a walk round
 * the face enters the run to the edge where the walk leaves it. A face whose full corners are
 * opposite has two such runs, or one that joins them through the middle of the face: it is
 * ambiguous, and the tables have a variant for either. The walks of the two cells beside a face run
 * in opposite directions, and so do the segments, which makes all triangles face the same side.
 * Each crossed edge ends one segment and starts another, so that the segments of a cube form loops.
 *
 * A loop is cut into triangles by diagonals. None may lie in a face: the cube on the other side
 * could have the same one, and four triangles would meet there.
 */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { CORNERS = 8, EDGES = 12, FACES = 6, CASES = 1 << CORNERS };

/* Room for the variants of all cases, most of which have no ambiguous face, and for the triangles
 * of a variant: no loops have more than 12 edges together. */
enum { VARIANTS_MAX = 1024, TRIANGLES_MAX = EDGES - 2 };

/* Costs of diagonals: the squared length in half edges of the cube, or one of these. */
enum { IN_FACE = 1000, IMPOSSIBLE = 1000000 };

struct cube_edge {
	int from, to;  /* corners */
	int faces;     /* the two that it borders on, as bits */
	int middle[3]; /* in half edges of the cube */
};

struct cube_face {
	int corner[4];     /* as a walk round it meets them, counter-clockwise seen from outside */
	bool lowest_first; /* corner[0] and [2] are the pair with the lowest and highest corner */
};

struct table {
	int first[CASES], ambiguous[CASES];
	int variants;
	int offset[VARIANTS_MAX +
		   1]; /* of the variant's triangles in `edge`, where the next begin */
	uint8_t edge[VARIANTS_MAX * 3 * TRIANGLES_MAX];
};

static struct cube_edge edges[EDGES];
static struct cube_face faces[FACES];
static int edge_between[CORNERS][CORNERS];

/* The other two axes, the lower one first. */
static void other_axes(int axis, int *out_u, int *out_v)
{
	*out_u = axis == 0 ? 1 : 0;
	*out_v = axis == 2 ? 1 : 2;
}

static void make_edges(void)
{
	for (int e = 0; e < EDGES; e++) {
		const int axis = e / 4;
		int u, v;
		other_axes(axis, &u, &v);
		const int from = (e & 1) << u | (e >> 1 & 1) << v, to = from | 1 << axis;
		edges[e] = (struct cube_edge) { .from = from, .to = to };
		for (int a = 0; a < 3; a++)
			edges[e].middle[a] = (from >> a & 1) + (to >> a & 1);
		edges[e].faces = 1 << (2 * u + (from >> u & 1)) | 1 << (2 * v + (from >> v & 1));
		edge_between[from][to] = edge_between[to][from] = e;
	}
}

/* Face 2 * axis + side. */
static void make_faces(void)
{
	static const int round[4] = { 0, 1, 3, 2 };
	for (int f = 0; f < FACES; f++) {
		const int axis = f / 2, side = f % 2;
		const int u = (axis + 1) % 3, v = (axis + 2) % 3;
		for (int i = 0; i < 4; i++) {
			/* from u to v is counter-clockwise seen from the axis' upper end */
			const int at = round[side ? i : 3 - i];
			faces[f].corner[i] = side << axis | (at & 1) << u | at >> 1 << v;
		}
		faces[f].lowest_first = side;
	}
}

static bool full(int set, int corner)
{
	return set >> corner & 1;
}

static bool is_ambiguous(int set, const struct cube_face *face)
{
	const int *c = face->corner;
	return full(set, c[0]) == full(set, c[2]) && full(set, c[1]) == full(set, c[3]) &&
	       full(set, c[0]) != full(set, c[1]);
}

/*
 * Add the segments of a face to next[], which has for each edge the one where its segment ends.
 * lowest_joined: on an ambiguous face, the lowest and the highest corner are on one side.
 */
static void add_segments(int set, const struct cube_face *face, bool lowest_joined, int next[EDGES])
{
	const int *c = face->corner;
	for (int i = 0; i < 4; i++) {
		const int here = c[i], before = c[(i + 3) % 4];
		if (!full(set, here) || full(set, before))
			continue;
		const int enters = edge_between[before][here];
		int leaves = i;
		const bool pair_is_lowest = (i % 2 == 0) == face->lowest_first;
		if (is_ambiguous(set, face) && pair_is_lowest == lowest_joined) {
			/* round the empty corner before this one */
			next[enters] = edge_between[before][c[(i + 2) % 4]];
			continue;
		}
		while (full(set, c[(leaves + 1) % 4]))
			leaves = (leaves + 1) % 4;
		next[enters] = edge_between[c[leaves]][c[(leaves + 1) % 4]];
	}
}

/* One cube: its loops, and what its diagonals cost. */
struct cube {
	int set;
	int next[EDGES]; /* -1: the edge is not crossed */
};

static bool share_corner(const struct cube_edge *a, const struct cube_edge *b)
{
	return a->from == b->from || a->from == b->to || a->to == b->from || a->to == b->to;
}

/*
 * Some loops cannot be cut without a diagonal in an ambiguous face. The cubes on its two sides then
 * choose from different ones: the lower side of a cube takes edges that meet in a corner, the upper
 * side takes opposite edges.
 */
static bool may_lie_in_face(const struct cube *cube, int a, int b)
{
	int f = 0;
	while (!(edges[a].faces & edges[b].faces & 1 << f))
		f++;
	return is_ambiguous(cube->set, &faces[f]) && cube->next[a] != b && cube->next[b] != a &&
	       share_corner(&edges[a], &edges[b]) == (f % 2 == 0);
}

static int diagonal_cost(const struct cube *cube, int a, int b)
{
	if (edges[a].faces & edges[b].faces)
		return may_lie_in_face(cube, a, b) ? IN_FACE : IMPOSSIBLE;
	int sum = 0;
	for (int axis = 0; axis < 3; axis++) {
		const int d = edges[a].middle[axis] - edges[b].middle[axis];
		sum += d * d;
	}
	return sum;
}

/* A loop, and how its parts are cut best. */
struct cutting {
	const struct cube *cube;
	int count;
	int edge[EDGES];
	int tip[EDGES][EDGES]; /* of the triangle on the side from i to j of such a part */
};

static int side_cost(const struct cutting *cut, int i, int j)
{
	return j - i > 1 ? diagonal_cost(cut->cube, cut->edge[i], cut->edge[j]) : 0;
}

/* The least cost of the diagonals that cut the part of a loop from i to j into triangles. */
static int cut_part(struct cutting *cut, int i, int j)
{
	int best = j - i < 2 ? 0 : IMPOSSIBLE;
	for (int k = i + 1; k < j; k++) {
		const int cost = cut_part(cut, i, k) + cut_part(cut, k, j) + side_cost(cut, i, k) +
				 side_cost(cut, k, j);
		if (cost < best) {
			best = cost;
			cut->tip[i][j] = k;
		}
	}
	return best;
}

static void add_triangles(const struct cutting *cut, int i, int j, struct table *table)
{
	if (j - i < 2)
		return;
	const int k = cut->tip[i][j];
	uint8_t *to = table->edge + 3 * (size_t)table->offset[table->variants];
	to[0] = (uint8_t)cut->edge[i];
	to[1] = (uint8_t)cut->edge[k];
	to[2] = (uint8_t)cut->edge[j];
	table->offset[table->variants]++;
	add_triangles(cut, i, k, table);
	add_triangles(cut, k, j, table);
}

static void add_loop(struct cube *cube, int start, bool done[EDGES], struct table *table)
{
	struct cutting cut = { .cube = cube };
	for (int e = start; !done[e]; e = cube->next[e]) {
		done[e] = true;
		cut.edge[cut.count++] = e;
	}
	if (cut_part(&cut, 0, cut.count - 1) >= IMPOSSIBLE) {
		fprintf(stderr, "make_cube_tables: corners %02x: a loop cannot be cut\n",
			cube->set);
		exit(EXIT_FAILURE);
	}
	add_triangles(&cut, 0, cut.count - 1, table);
}

/* Bit n of `joined` decides on the n-th ambiguous face. */
static void add_variant(int set, int joined, struct table *table)
{
	struct cube cube = { .set = set };
	bool done[EDGES] = { false };
	for (int e = 0; e < EDGES; e++)
		cube.next[e] = -1;
	for (int f = 0; f < FACES; f++) {
		const bool ambiguous = is_ambiguous(set, &faces[f]);
		add_segments(set, &faces[f], ambiguous && (joined & 1), cube.next);
		joined >>= ambiguous;
	}
	table->offset[table->variants + 1] = table->offset[table->variants];
	table->variants++;
	for (int e = 0; e < EDGES; e++)
		if (cube.next[e] >= 0 && !done[e])
			add_loop(&cube, e, done, table);
}

static void add_case(int set, struct table *table)
{
	int ambiguous = 0, count = 0;
	for (int f = 0; f < FACES; f++) {
		if (!is_ambiguous(set, &faces[f]))
			continue;
		ambiguous |= 1 << f;
		count++;
	}
	table->first[set] = table->variants;
	table->ambiguous[set] = ambiguous;
	for (int joined = 0; joined < 1 << count; joined++)
		add_variant(set, joined, table);
}

static void print_numbers(FILE *out, const char *declaration, const int *numbers, int count)
{
	fprintf(out, "\nconst %s[%d] = {", declaration, count);
	for (int i = 0; i < count; i++)
		fprintf(out, "%s%d,", i % 16 ? " " : "\n\t", numbers[i]);
	fprintf(out, "\n};\n");
}

static void print_table(FILE *out, const struct table *table)
{
	static int corners[sizeof table->edge];
	const int length = 3 * table->offset[table->variants];
	for (int i = 0; i < length; i++)
		corners[i] = table->edge[i];
	fprintf(out, "/* Made by make_cube_tables.c. */\n#include \"render/mesh/cube_tables.h\"\n");
	print_numbers(out, "uint16_t gz_cube_first", table->first, CASES);
	print_numbers(out, "uint8_t gz_cube_ambiguous", table->ambiguous, CASES);
	print_numbers(out, "uint16_t gz_cube_offset", table->offset, table->variants + 1);
	print_numbers(out, "uint8_t gz_cube_corners", corners, length);
	fprintf(out, "\nconst int gz_cube_variants = %d;\n", table->variants);
}

int main(int argc, char **argv)
{
	static struct table table;
	FILE *out = argc == 2 ? fopen(argv[1], "w") : NULL;
	if (!out) {
		fputs("make_cube_tables FILE: cannot be written\n", stderr);
		return EXIT_FAILURE;
	}
	make_edges();
	make_faces();
	for (int set = 0; set < CASES; set++)
		add_case(set, &table);
	print_table(out, &table);
	const bool failed = ferror(out) != 0;
	return fclose(out) == 0 && !failed ? EXIT_SUCCESS : EXIT_FAILURE;
}
