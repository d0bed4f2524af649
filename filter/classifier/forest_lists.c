#include "filter/classifier/forest_lists.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* A question whose unusual answer excludes leaves of a tree. */
struct list_entry {
	float threshold;
	uint32_t kept; /* the leaves that it does not exclude */
	uint32_t tree;
};

/* Each feature has two lists: questions that exclude if the feature is not below the threshold, the
 * least threshold first; and those that exclude if it is below, the greatest first. An entry that
 * no feature passes ends each list. */
enum { EXCLUDES_BELOW, EXCLUDES_ABOVE, KINDS };

/* Room for the classes side by side, so that they are added at once: a power of two. */
enum { CLASS_ROOM = 8 };

/* The scores of a leaf; 0 beyond the classes that the forest knows. */
struct leaf_scores {
	int16_t of[CLASS_ROOM];
};

typedef int16_t class_scores __attribute__((vector_size(sizeof(struct leaf_scores))));
typedef int32_t class_sums __attribute__((vector_size(sizeof(int32_t) * CLASS_ROOM)));

struct gz_forest_lists {
	size_t tree_count;
	int32_t base[CLASS_ROOM];
	uint32_t first[GZ_MOVEMENT_FEATURES][KINDS]; /* of each list, in entries */
	struct list_entry *entries;
	struct leaf_scores *leaves; /* GZ_FOREST_LIST_LEAVES for each tree, in the order in which
				       they are excluded */
};

/* What the features usually are: the medians over the simulated viewer at 500 Hz. Only the speed
 * depends on them. */
/* clang-format off */
static const float usual_features[GZ_MOVEMENT_FEATURES] = {
	31.75F, 31.7F, 31.68F, 31.66F, 31.64F, 31.58F, 31.56F, 31.55F, 0.0F, 0.0F, 0.0F, 0.0F,
	0.0F, 0.1316F, 0.257F, 0.5006F, 0.07247F, 0.6855F, 0.0F, 0.1445F, 0.5178F, 0.2777F,
	0.08984F, 0.5505F, 0.0F, 0.1715F, 1.045F, 0.1672F, 0.1028F, 0.4714F, 0.0F, 0.2435F,
	2.119F, 0.1201F, 0.1149F, 0.4814F, 0.0F, 0.8937F, 4.389F, 0.2152F, 0.2622F, 1.281F, 0.0F,
	3.269F, 10.8F, 0.3269F, 1.123F, 3.292F, 0.0F, 5.51F, 20.14F, 0.2841F, 2.231F, 4.177F,
	0.0F, 0.078F, 0.0063F, 0.0872F, 0.0114F, 0.1592F, 0.0371F, 1.857F, 0.2007F, -0.539F,
	-0.4569F, -0.2403F, 0.05386F, 0.2821F, 0.4892F, 30.47F, 176.0F, 1000.0F, 102.0F, 447.0F,
	20.0F, 6.503F, 0.07012F, -0.3932F, 186.0F, 0.8633F, 0.09794F, 136.0F, 0.05747F, 0.8333F,
	0.4333F, 0.0F, 210.0F, 0.02639F, 2.711F, 2.687F, 0.03204F, 2.576F, 2.974F, -3.0F, -3.0F,
	1.0F, 0.8469F, 1.203F, 0.0F, 0.2538F, 0.07477F,
};
/* clang-format on */

static bool is_leaf(const struct gz_forest_node *root, uint8_t at)
{
	return root[at].next[0] == at;
}

/* Which leaves the question excludes by its unusual answer: those of the side of the usual one. */
static int kind_of(const struct gz_forest_node *node)
{
	return usual_features[node->feature] < node->threshold ? EXCLUDES_BELOW : EXCLUDES_ABOVE;
}

/* An entry and its list: feature and kind. */
struct unsorted_entry {
	struct list_entry entry;
	int list;
};

/* One tree being put into lists. */
struct list_maker {
	struct gz_forest_lists *lists;
	const struct gz_forest *forest;
	uint32_t tree;
	uint32_t leaf_count; /* so far, in the order in which they are excluded */
	uint32_t entry_count;
	struct unsorted_entry *entries; /* of all trees */
};

/* A subtree in front of which a walk is, and how far it has come there. */
struct list_step {
	uint8_t at;
	uint8_t done; /* sides */
	uint32_t first_leaf;
};

static void take_list_leaf(struct list_maker *maker, const struct gz_forest_tree *tree,
			   const struct gz_forest_node *leaf)
{
	size_t to = maker->tree * (size_t)GZ_FOREST_LIST_LEAVES + maker->leaf_count++;
	size_t classes = (size_t)maker->forest->class_count;
	const int16_t *scores = maker->forest->leaf + (tree->leaf + leaf->leaf) * classes;
	memcpy(maker->lists->leaves[to].of, scores, classes * sizeof scores[0]);
}

/* Bits @p first to @p end - 1. */
static uint32_t bits_between(uint32_t first, uint32_t end)
{
	uint64_t below_end = (UINT64_C(1) << end) - 1, below_first = (UINT64_C(1) << first) - 1;
	return (uint32_t)(below_end & ~below_first);
}

static void take_list_question(struct list_maker *maker, const struct gz_forest_node *node,
			       uint32_t first_leaf)
{
	maker->entries[maker->entry_count++] = (struct unsorted_entry) {
		.entry = { .threshold = node->threshold,
			   .kept = ~bits_between(first_leaf, maker->leaf_count),
			   .tree = maker->tree },
		.list = node->feature * KINDS + kind_of(node),
	};
}

/* Put a tree into the lists. The side that a question can exclude comes first, so that the first
 * leaf that is left is the one that a walk finds: each question on the way to a later leaf that is
 * left would have excluded the way to an earlier one. */
static bool take_list_tree(struct list_maker *maker)
{
	const struct gz_forest_tree *tree = &maker->forest->tree[maker->tree];
	const struct gz_forest_node *root = maker->forest->node + tree->node;
	struct list_step steps[GZ_FOREST_LIST_LEAVES] = { { .at = 0 } };
	size_t depth = 1;
	maker->leaf_count = 0;
	while (depth > 0) {
		struct list_step *step = &steps[depth - 1];
		const struct gz_forest_node *node = &root[step->at];
		if (is_leaf(root, step->at)) {
			if (maker->leaf_count == GZ_FOREST_LIST_LEAVES)
				return false;
			take_list_leaf(maker, tree, node);
			depth--;
			continue;
		}
		if (step->done == 1)
			take_list_question(maker, node, step->first_leaf);
		if (step->done == 2) {
			depth--;
			continue;
		}
		if (depth == GZ_FOREST_LIST_LEAVES)
			return false;
		int side = kind_of(node) == EXCLUDES_BELOW ? step->done : 1 - step->done;
		step->done++;
		steps[depth++] = (struct list_step) { .at = node->next[side],
						      .first_leaf = maker->leaf_count };
	}
	return true;
}

/* By list, and within it in the order in which it is read. */
static int compare_unsorted(const void *a, const void *b)
{
	const struct unsorted_entry *x = a, *y = b;
	float first = x->entry.threshold, second = y->entry.threshold;
	int rising = (first > second) - (first < second);
	if (x->list != y->list)
		return x->list < y->list ? -1 : 1;
	return x->list % KINDS == EXCLUDES_BELOW ? rising : -rising;
}

/* Put the entries into their lists, in order. */
static void sort_lists(struct list_maker *maker)
{
	struct gz_forest_lists *lists = maker->lists;
	uint32_t next = 0, end = 0;
	qsort(maker->entries, maker->entry_count, sizeof maker->entries[0], compare_unsorted);
	for (int list = 0; list < GZ_MOVEMENT_FEATURES * KINDS; list++) {
		int kind = list % KINDS;
		lists->first[list / KINDS][kind] = end;
		for (; next < maker->entry_count && maker->entries[next].list == list; next++)
			lists->entries[end++] = maker->entries[next].entry;
		lists->entries[end++] =
			(struct list_entry) { .threshold = kind == EXCLUDES_BELOW ? INFINITY
										  : -INFINITY };
	}
}

static void free_lists(struct gz_forest_lists *lists)
{
	if (lists) {
		free(lists->entries);
		free(lists->leaves);
	}
	free(lists);
}

/* @return NULL: no memory, or a tree with too many leaves */
static struct gz_forest_lists *make_lists(const struct gz_forest *forest)
{
	const size_t trees = forest->tree_count, most = trees * GZ_FOREST_LIST_LEAVES;
	struct list_maker maker = { .forest = forest };
	struct gz_forest_lists *lists = maker.lists = calloc(1, sizeof *lists);
	if (!lists || trees == 0 || trees > GZ_FOREST_LIST_TREES) {
		free_lists(lists);
		return NULL;
	}
	lists->tree_count = trees;
	for (int k = 0; k < GZ_FOREST_CLASSES; k++)
		lists->base[k] = k < forest->class_count ? forest->base[k] : GZ_FOREST_NEVER;
	lists->entries =
		calloc(most + (size_t)GZ_MOVEMENT_FEATURES * KINDS, sizeof *lists->entries);
	lists->leaves = calloc(trees * GZ_FOREST_LIST_LEAVES, sizeof *lists->leaves);
	maker.entries = calloc(most, sizeof *maker.entries);
	bool made = lists->entries && lists->leaves && maker.entries;
	for (; made && maker.tree < trees; maker.tree++)
		made = take_list_tree(&maker);
	if (made)
		sort_lists(&maker);
	free(maker.entries);
	if (made)
		return lists;
	free_lists(lists);
	return NULL;
}

const struct gz_forest_lists *gz_forest_lists_of(const struct gz_forest *forest)
{
	static _Atomic(struct gz_forest_lists *) made[2];
	if (forest != &gz_forest_at_once && forest != &gz_forest_certain)
		return NULL;
	_Atomic(struct gz_forest_lists *) *place = &made[forest == &gz_forest_certain];
	struct gz_forest_lists *lists = atomic_load_explicit(place, memory_order_acquire);
	if (lists)
		return lists;
	struct gz_forest_lists *ours = make_lists(forest);
	if (!ours || atomic_compare_exchange_strong(place, &lists, ours))
		return ours;
	free_lists(ours); /* another thread was first */
	return lists;
}

/* Exclude leaves by all questions with unusual answers. @param left  of each tree, all bits set */
static void exclude_leaves(const struct gz_forest_lists *lists,
			   const float features[GZ_MOVEMENT_FEATURES], uint32_t *left)
{
	for (int f = 0; f < GZ_MOVEMENT_FEATURES; f++) {
		const float value = features[f];
		const struct list_entry *entry = &lists->entries[lists->first[f][EXCLUDES_BELOW]];
		for (; value >= entry->threshold; entry++)
			left[entry->tree] &= entry->kept;
		entry = &lists->entries[lists->first[f][EXCLUDES_ABOVE]];
		for (; value < entry->threshold; entry++)
			left[entry->tree] &= entry->kept;
	}
}

void gz_forest_lists_score(const struct gz_forest_lists *lists,
			   const float features[GZ_MOVEMENT_FEATURES],
			   int32_t out_scores[GZ_FOREST_CLASSES])
{
	uint32_t left[GZ_FOREST_LIST_TREES];
	class_sums sums;
	const struct leaf_scores *leaves = lists->leaves;
	memset(left, 0xff, lists->tree_count * sizeof left[0]);
	exclude_leaves(lists, features, left);
	memcpy(&sums, lists->base, sizeof sums);
	for (size_t t = 0; t < lists->tree_count; t++, leaves += GZ_FOREST_LIST_LEAVES) {
		class_scores scores;
		memcpy(&scores, &leaves[__builtin_ctz(left[t])], sizeof scores);
		sums += __builtin_convertvector(scores, class_sums);
	}
	memcpy(out_scores, &sums, GZ_FOREST_CLASSES * sizeof out_scores[0]);
}
