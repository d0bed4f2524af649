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

/* The questions about each feature are a list, the least threshold first. It begins with an entry
 * that every feature passes, and ends with one that none does. */
struct gz_forest_lists {
	const struct gz_forest *forest;
	uint16_t first[GZ_MOVEMENT_FEATURES]; /* behind the entry that every feature passes */
	struct list_entry *entries;
	struct list_leaf *leaves; /* GZ_FOREST_LIST_LEAVES for each tree */
};

/* A place of 16 bits is enough. */
_Static_assert(GZ_FOREST_LIST_LEAVES *GZ_FOREST_LIST_TREES + 2 * GZ_MOVEMENT_FEATURES < UINT16_MAX,
	       "every entry has a place");

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
	size_t entry_count;
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

/* A node that a walk has not visited yet, and the questions on the way to it. */
struct open_node {
	uint8_t at;
	uint32_t asked;
};

/* Put a tree into the lists. @return false: it is too large */
static bool take_list_tree(struct list_maker *maker, size_t tree)
{
	const struct gz_forest_node *root = maker->forest->node + maker->forest->tree[tree].node;
	struct open_node open[GZ_FOREST_LIST_LEAVES + 1] = { { .at = 0 } };
	size_t open_count = 1;
	uint16_t questions = 0;
	while (open_count > 0) {
		const struct open_node here = open[--open_count];
		const struct gz_forest_node *node = &root[here.at];
		if (is_leaf(root, here.at) && node->leaf < GZ_FOREST_LIST_LEAVES) {
			take_list_leaf(maker, tree, node->leaf, here.asked);
			continue;
		}
		/* A tree has one question less than leaves, and each open node has a leaf. */
		if (is_leaf(root, here.at) || questions == GZ_FOREST_LIST_LEAVES - 1)
			return false;
		const uint32_t asked = here.asked | UINT32_C(1) << questions;
		maker->entries[maker->entry_count++] =
			(struct unsorted_entry) { { node->threshold, (uint16_t)tree, questions++ },
						  node->feature };
		open[open_count++] = (struct open_node) { node->next[0], asked };
		open[open_count++] = (struct open_node) { node->next[1], asked };
	}
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
	lists->leaves = calloc(most, sizeof *lists->leaves);
	maker.entries = calloc(most, sizeof *maker.entries);
	bool made = lists->entries && lists->leaves && maker.entries;
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

/* Trees that must be walked again. */
struct stale_trees {
	size_t count;
	uint16_t tree[GZ_FOREST_LIST_TREES];
};

/* The answer to a question changes. */
static inline void change_answer(struct gz_forest_walks *walks, const struct list_entry *entry,
				 struct stale_trees *stale)
{
	uint32_t *asked = &walks->asked[entry->tree];
	if ((*asked >> entry->number & 1) == 0)
		return;
	*asked = 0; /* it is in the list once */
	stale->tree[stale->count++] = entry->tree;
}

/* Move a feature past thresholds. */
static void move_feature(const struct gz_forest_lists *lists, struct gz_forest_walks *walks,
			 size_t feature, float value, struct stale_trees *stale)
{
	const struct list_entry *entry = &lists->entries[walks->place[feature]];
	for (; value >= entry->threshold; entry++)
		change_answer(walks, entry, stale);
	for (; value < entry[-1].threshold; entry--)
		change_answer(walks, entry - 1, stale);
	walks->place[feature] = (uint16_t)(entry - lists->entries);
	walks->low[feature] = entry[-1].threshold;
	walks->high[feature] = entry->threshold;
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

/* The leaf that the newest walk of a tree found. */
static inline const struct list_leaf *found_leaf(const struct gz_forest_lists *lists,
						 const struct gz_forest_walks *walks, size_t tree)
{
	return &lists->leaves[tree * GZ_FOREST_LIST_LEAVES + walks->leaf[tree]];
}

/* Walk a tree from its root. @return the leaf */
static inline const struct list_leaf *walk_tree(const struct gz_forest_lists *lists,
						struct gz_forest_walks *walks, size_t tree,
						const float *features)
{
	const struct gz_forest *forest = lists->forest;
	const struct gz_forest_node *root = forest->node + forest->tree[tree].node;
	const struct gz_forest_node *node = root, *before;
	do {
		before = node;
		node = root + node->next[features[node->feature] >= node->threshold];
	} while (node != before);
	walks->leaf[tree] = node->leaf;
	const struct list_leaf *leaf = found_leaf(lists, walks, tree);
	walks->asked[tree] = leaf->asked;
	return leaf;
}

/* Walk trees again, and change the scores by what changes in them. */
static void walk_stale_trees(const struct gz_forest_lists *lists, struct gz_forest_walks *walks,
			     const struct stale_trees *stale, const float *features)
{
	four_sums sums;
	memcpy(&sums, walks->scores, sizeof sums);
	for (size_t i = 0; i < stale->count; i++) {
		const struct list_leaf *before = found_leaf(lists, walks, stale->tree[i]);
		const struct list_leaf *now = walk_tree(lists, walks, stale->tree[i], features);
		sums += first_scores(now) - first_scores(before);
		walks->scores[4] += now->score[4] - before->score[4];
	}
	memcpy(walks->scores, &sums, sizeof sums);
}

_Static_assert(GZ_FOREST_CLASSES == 5, "walk_stale_trees() knows all classes");

/* Walk all trees. */
static void begin_walks(const struct gz_forest_lists *lists, struct gz_forest_walks *walks,
			const float *features)
{
	const struct gz_forest *forest = lists->forest;
	struct stale_trees none = { .count = 0 };
	memset(walks, 0, sizeof *walks);
	for (size_t f = 0; f < GZ_MOVEMENT_FEATURES; f++) {
		walks->place[f] = lists->first[f];
		move_feature(lists, walks, f, features[f], &none);
	}
	for (int k = 0; k < GZ_FOREST_CLASSES; k++)
		walks->scores[k] = k < forest->class_count ? forest->base[k] : GZ_FOREST_NEVER;
	for (size_t tree = 0; tree < forest->tree_count; tree++) {
		const struct list_leaf *leaf = walk_tree(lists, walks, tree, features);
		for (int k = 0; k < GZ_FOREST_CLASSES; k++)
			walks->scores[k] += leaf->score[k];
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
		begin_walks(lists, walks, features);
	for (size_t f = 0; f < GZ_MOVEMENT_FEATURES; f++)
		if (features[f] < walks->low[f] || features[f] >= walks->high[f])
			move_feature(lists, walks, f, features[f], &stale);
	walk_stale_trees(lists, walks, &stale, features);
	memcpy(out_scores, walks->scores, sizeof walks->scores);
}
