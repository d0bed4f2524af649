#include "filter/classifier/forest_lists.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* A question of a tree. */
struct list_entry {
	float threshold;
	uint16_t tree;
	uint16_t number; /* among the questions of the tree */
};

/* A leaf. What a walk needs of it lies together. */
struct list_leaf {
	int16_t score[6]; /* of each class; 0 beyond those that the forest knows */
	uint32_t asked;   /* questions on the way to it, bits */
};

_Static_assert(GZ_FOREST_CLASSES <= 6, "a leaf has room for all classes");

/* A node of a tree: the next one is at below if the feature is below the threshold, and behind that
 * if it is not. A leaf is its own successor, because no feature reaches its threshold. The nodes of
 * a tree lie side by side, those nearest to the root first. */
struct list_node {
	float threshold;
	uint16_t below; /* among the nodes of all trees */
	uint8_t feature;
	uint8_t leaf;
};

enum { NODES_MAX = 2 * GZ_FOREST_LIST_LEAVES - 1 }; /* of a tree */

/* The questions about each feature are a list, the least threshold first. It begins with an entry
 * that every feature passes, and ends with one that none does. */
struct gz_forest_lists {
	const struct gz_forest *forest;
	int depth;                            /* questions on the longest way to a leaf */
	uint16_t first[GZ_MOVEMENT_FEATURES]; /* behind the entry that every feature passes */
	uint16_t root[GZ_FOREST_LIST_TREES];
	struct list_entry *entries;
	struct list_node *nodes;
	struct list_leaf *leaves; /* GZ_FOREST_LIST_LEAVES for each tree */
};

/* Places of 16 bits are enough. */
_Static_assert(NODES_MAX *GZ_FOREST_LIST_TREES + 2 * GZ_MOVEMENT_FEATURES < UINT16_MAX,
	       "every entry and every node has a place");

static bool is_leaf(const struct gz_forest_node *root, uint8_t at)
{
	return root[at].next[0] == at;
}

/* An entry and the feature in whose list it is. */
struct unsorted_entry {
	struct list_entry entry;
	uint8_t feature;
};

/* A forest being put into lists. */
struct list_maker {
	struct gz_forest_lists *lists;
	const struct gz_forest *forest;
	struct unsorted_entry *entries; /* of all trees */
	size_t entry_count, node_count;
};

/* A node that waits for its place, and the questions on the way to it. */
struct waiting_node {
	uint8_t at;
	int depth;
	uint32_t asked;
};

static void take_list_leaf(struct list_maker *maker, size_t tree, uint8_t leaf, uint32_t asked)
{
	const size_t classes = (size_t)maker->forest->class_count;
	const int16_t *scores =
		maker->forest->leaf + (maker->forest->tree[tree].leaf + leaf) * classes;
	struct list_leaf *to = &maker->lists->leaves[tree * GZ_FOREST_LIST_LEAVES + leaf];
	memcpy(to->score, scores, classes * sizeof scores[0]);
	to->asked = asked;
}

/* Put a tree into the lists, one level after the other. @return false: it is too large */
static bool take_list_tree(struct list_maker *maker, size_t tree)
{
	struct gz_forest_lists *lists = maker->lists;
	const struct gz_forest_node *root = maker->forest->node + maker->forest->tree[tree].node;
	struct list_node *nodes = lists->nodes + maker->node_count;
	struct waiting_node waiting[NODES_MAX] = { { .at = 0 } };
	size_t count = 1;
	uint16_t questions = 0;
	lists->root[tree] = (uint16_t)maker->node_count;
	for (size_t i = 0; i < count; i++) {
		const struct waiting_node here = waiting[i];
		const struct gz_forest_node *node = &root[here.at];
		if (is_leaf(root, here.at)) {
			nodes[i] = (struct list_node) { INFINITY, (uint16_t)(maker->node_count + i),
							0, node->leaf };
			if (node->leaf >= GZ_FOREST_LIST_LEAVES)
				return false;
			take_list_leaf(maker, tree, node->leaf, here.asked);
			continue;
		}
		if (count + 2 > NODES_MAX)
			return false;
		nodes[i] =
			(struct list_node) { node->threshold, (uint16_t)(maker->node_count + count),
					     node->feature, 0 };
		const uint32_t asked = here.asked | UINT32_C(1) << questions;
		for (int side = 0; side < 2; side++)
			waiting[count++] =
				(struct waiting_node) { node->next[side], here.depth + 1, asked };
		maker->entries[maker->entry_count++] =
			(struct unsorted_entry) { { node->threshold, (uint16_t)tree, questions++ },
						  node->feature };
	}
	if (waiting[count - 1].depth > lists->depth)
		lists->depth = waiting[count - 1].depth;
	maker->node_count += count;
	return true;
}

/* By feature, and within it by threshold. */
static int compare_unsorted(const void *a, const void *b)
{
	const struct unsorted_entry *x = a, *y = b;
	const float first = x->entry.threshold, second = y->entry.threshold;
	if (x->feature != y->feature)
		return x->feature < y->feature ? -1 : 1;
	return (first > second) - (first < second);
}

/* Put the entries into their lists, in order. */
static void sort_lists(struct list_maker *maker)
{
	struct gz_forest_lists *lists = maker->lists;
	struct unsorted_entry *entries = maker->entries;
	size_t next = 0, end = 0;
	qsort(entries, maker->entry_count, sizeof entries[0], compare_unsorted);
	for (int f = 0; f < GZ_MOVEMENT_FEATURES; f++) {
		lists->entries[end++].threshold = -INFINITY;
		lists->first[f] = (uint16_t)end;
		for (; next < maker->entry_count && entries[next].feature == f; next++)
			lists->entries[end++] = entries[next].entry;
		lists->entries[end++].threshold = INFINITY;
	}
}

static void free_lists(struct gz_forest_lists *lists)
{
	if (lists) {
		free(lists->entries);
		free(lists->nodes);
		free(lists->leaves);
	}
	free(lists);
}

/* @return NULL: no memory, or the forest is too large */
static struct gz_forest_lists *make_lists(const struct gz_forest *forest)
{
	const size_t trees = forest->tree_count, most = trees * GZ_FOREST_LIST_LEAVES;
	struct list_maker maker = { .forest = forest };
	struct gz_forest_lists *lists = maker.lists = calloc(1, sizeof *lists);
	if (!lists || trees == 0 || trees > GZ_FOREST_LIST_TREES) {
		free_lists(lists);
		return NULL;
	}
	lists->forest = forest;
	lists->entries = calloc(most + 2 * (size_t)GZ_MOVEMENT_FEATURES, sizeof *lists->entries);
	lists->nodes = calloc(trees * NODES_MAX, sizeof *lists->nodes);
	lists->leaves = calloc(most, sizeof *lists->leaves);
	maker.entries = calloc(most, sizeof *maker.entries);
	bool made = lists->entries && lists->nodes && lists->leaves && maker.entries;
	for (size_t tree = 0; made && tree < trees; tree++)
		made = take_list_tree(&maker, tree);
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

/*
 * What changes from one sample to the next cannot be foretold, so branches on it would cost more
 * than what they skip. Hence the arithmetic with conditions below.
 */

/* Trees that are walked side by side: each answer leads to the next question, so one tree alone
 * leaves the processor waiting. Chosen: half of those that a usual sample changes. */
enum { TREES_AT_ONCE = 8 };

/* Trees that must be walked again, with room for one candidate and for whole groups. */
struct stale_trees {
	size_t count;
	uint16_t tree[GZ_FOREST_LIST_TREES + TREES_AT_ONCE];
};

/* The answer to a question changes: walk its tree again if the question was asked. */
static inline void change_answer(struct gz_forest_walks *walks, const struct list_entry *entry,
				 struct stale_trees *stale)
{
	const uint32_t asked = walks->asked[entry->tree];
	const uint32_t was_asked = asked >> entry->number & 1;
	stale->tree[stale->count] = entry->tree;
	stale->count += was_asked;
	walks->asked[entry->tree] = asked & (was_asked - 1); /* no longer: it is in the list once */
}

static void keep_place(const struct gz_forest_lists *lists, struct gz_forest_walks *walks,
		       size_t feature, const struct list_entry *entry)
{
	walks->place[feature] = (uint16_t)(entry - lists->entries);
	walks->low[feature] = entry[-1].threshold;
	walks->high[feature] = entry->threshold;
}

static void raise_feature(const struct gz_forest_lists *lists, struct gz_forest_walks *walks,
			  size_t feature, float value, struct stale_trees *stale)
{
	const struct list_entry *entry = &lists->entries[walks->place[feature]];
	for (; value >= entry->threshold; entry++)
		change_answer(walks, entry, stale);
	keep_place(lists, walks, feature, entry);
}

static void lower_feature(const struct gz_forest_lists *lists, struct gz_forest_walks *walks,
			  size_t feature, float value, struct stale_trees *stale)
{
	const struct list_entry *entry = &lists->entries[walks->place[feature]];
	for (; value < entry[-1].threshold; entry--)
		change_answer(walks, entry - 1, stale);
	keep_place(lists, walks, feature, entry);
}

/* Move the features that have passed thresholds. */
static void move_features(const struct gz_forest_lists *lists, struct gz_forest_walks *walks,
			  const float *features, struct stale_trees *stale)
{
	uint8_t raised[GZ_MOVEMENT_FEATURES + 1], lowered[GZ_MOVEMENT_FEATURES + 1];
	size_t raised_count = 0, lowered_count = 0;
	for (size_t f = 0; f < GZ_MOVEMENT_FEATURES; f++) {
		raised[raised_count] = lowered[lowered_count] = (uint8_t)f;
		raised_count += features[f] >= walks->high[f];
		lowered_count += features[f] < walks->low[f];
	}
	for (size_t i = 0; i < raised_count; i++)
		raise_feature(lists, walks, raised[i], features[raised[i]], stale);
	for (size_t i = 0; i < lowered_count; i++)
		lower_feature(lists, walks, lowered[i], features[lowered[i]], stale);
}

/* The scores of the first classes side by side, so that they are added at once. */
typedef int16_t four_scores __attribute__((vector_size(8)));
typedef int32_t four_sums __attribute__((vector_size(16)));

static inline four_sums first_scores(const struct list_leaf *leaf)
{
	four_scores scores;
	memcpy(&scores, leaf->score, sizeof scores);
	return __builtin_convertvector(scores, four_sums);
}

/* Find the leaves of trees, each among those of its tree. */
static inline void find_leaves(const struct gz_forest_lists *lists, const uint16_t *trees,
			       const float *features, uint8_t *out_leaves)
{
	size_t at[TREES_AT_ONCE];
#pragma GCC unroll 8
	for (size_t t = 0; t < TREES_AT_ONCE; t++)
		at[t] = lists->root[trees[t]];
	for (int i = 0; i < lists->depth; i++) {
#pragma GCC unroll 8
		for (size_t t = 0; t < TREES_AT_ONCE; t++) {
			const struct list_node *node = &lists->nodes[at[t]];
			at[t] = node->below + (size_t)(features[node->feature] >= node->threshold);
		}
	}
#pragma GCC unroll 8
	for (size_t t = 0; t < TREES_AT_ONCE; t++)
		out_leaves[t] = lists->nodes[at[t]].leaf;
}

/* The same tree may be there several times: only the first one changes anything. */
static void exchange_leaves(const struct gz_forest_lists *lists, struct gz_forest_walks *walks,
			    const uint16_t *trees, const uint8_t *leaves)
{
	four_sums sums;
	memcpy(&sums, walks->scores, sizeof sums);
	for (size_t t = 0; t < TREES_AT_ONCE; t++) {
		const struct list_leaf *of_tree =
			&lists->leaves[(size_t)trees[t] * GZ_FOREST_LIST_LEAVES];
		const struct list_leaf *before = of_tree + walks->leaf[trees[t]];
		const struct list_leaf *now = of_tree + leaves[t];
		sums += first_scores(now) - first_scores(before);
		walks->scores[4] += now->score[4] - before->score[4];
		walks->leaf[trees[t]] = leaves[t];
		walks->asked[trees[t]] = now->asked;
	}
	memcpy(walks->scores, &sums, sizeof sums);
}

_Static_assert(GZ_FOREST_CLASSES == 5, "exchange_leaves() knows all classes");

/* Walk trees again, and change the scores by what changes in them. */
static void walk_stale_trees(const struct gz_forest_lists *lists, struct gz_forest_walks *walks,
			     struct stale_trees *stale, const float *features)
{
	if (stale->count == 0)
		return;
	for (size_t i = 0; i < TREES_AT_ONCE; i++)
		stale->tree[stale->count + i] = stale->tree[stale->count - 1];
	for (size_t i = 0; i < stale->count; i += TREES_AT_ONCE) {
		uint8_t leaves[TREES_AT_ONCE];
		find_leaves(lists, stale->tree + i, features, leaves);
		exchange_leaves(lists, walks, stale->tree + i, leaves);
	}
}

/* Begin with every feature below all thresholds. */
static void begin_walks(const struct gz_forest_lists *lists, struct gz_forest_walks *walks)
{
	const struct gz_forest *forest = lists->forest;
	memset(walks, 0, sizeof *walks);
	for (size_t f = 0; f < GZ_MOVEMENT_FEATURES; f++)
		keep_place(lists, walks, f, &lists->entries[lists->first[f]]);
	for (int k = 0; k < GZ_FOREST_CLASSES; k++)
		walks->scores[k] = k < forest->class_count ? forest->base[k] : GZ_FOREST_NEVER;
	for (size_t tree = 0; tree < forest->tree_count; tree++) {
		size_t at = lists->root[tree];
		while (lists->nodes[at].below != at)
			at = lists->nodes[at].below;
		const uint8_t leaf = walks->leaf[tree] = lists->nodes[at].leaf;
		const struct list_leaf *now = &lists->leaves[tree * GZ_FOREST_LIST_LEAVES + leaf];
		walks->asked[tree] = now->asked;
		for (int k = 0; k < GZ_FOREST_CLASSES; k++)
			walks->scores[k] += now->score[k];
	}
	walks->begun = true;
}

void gz_forest_lists_score(const struct gz_forest_lists *lists, struct gz_forest_walks *walks,
			   const float features[GZ_MOVEMENT_FEATURES],
			   int32_t out_scores[GZ_FOREST_CLASSES])
{
	struct stale_trees stale;
	stale.count = 0;
	if (!walks->begun)
		begin_walks(lists, walks);
	move_features(lists, walks, features, &stale);
	walk_stale_trees(lists, walks, &stale, features);
	memcpy(out_scores, walks->scores, sizeof walks->scores);
}
