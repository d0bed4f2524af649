#include "drivers/gazepoint/gazepoint_xml.h"

#include <expat.h>
#include <stdalign.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

struct gz_gazepoint_xml {
	size_t used;
	unsigned long salt; /* of Expat's hash tables: nobody can choose names that collide */
	alignas(max_align_t) unsigned char bytes[GZ_GAZEPOINT_XML_ARENA];
};

/* Expat's memory functions take no pointer of ours: during a parse, and only then, this one tells
 * them whose memory it is. */
static _Thread_local struct gz_gazepoint_xml *parsing;

/* Before each piece stands its size, for realloc(). */
union head {
	size_t size;
	max_align_t align;
};

static void *arena_malloc(size_t size)
{
	struct gz_gazepoint_xml *xml = parsing;
	size_t room = sizeof xml->bytes - xml->used;
	if (size > sizeof xml->bytes || room < sizeof(union head))
		return NULL;
	size_t rounded = (size + alignof(max_align_t) - 1) & ~(alignof(max_align_t) - 1);
	if (rounded > room - sizeof(union head))
		return NULL;
	union head *head = (union head *)(void *)(xml->bytes + xml->used);
	head->size = size;
	xml->used += sizeof *head + rounded;
	return head + 1;
}

static void *arena_realloc(void *old, size_t size)
{
	if (!old)
		return arena_malloc(size);
	size_t old_size = ((union head *)old - 1)->size;
	if (size <= old_size)
		return old;
	void *grown = arena_malloc(size);
	if (grown)
		memcpy(grown, old, old_size);
	return grown;
}

/* All is freed at once, by the next parse. */
static void arena_free(void *old)
{
	(void)old;
}

struct visit {
	XML_Parser parser;
	gz_gazepoint_element *on_element;
	void *user;
	int elements;
};

static void XMLCALL take_start(void *user, const XML_Char *name, const XML_Char **attributes)
{
	struct visit *visit = user;
	if (++visit->elements > 1)
		XML_StopParser(visit->parser, XML_FALSE);
	else
		visit->on_element(visit->user, name, (const char *const *)attributes);
}

static void XMLCALL refuse_type(void *user, const XML_Char *name, const XML_Char *system,
				const XML_Char *public, int has_internal_subset)
{
	const struct visit *visit = user;
	(void)name;
	(void)system;
	(void)public;
	(void)has_internal_subset;
	XML_StopParser(visit->parser, XML_FALSE);
}

enum gz_result gz_gazepoint_xml_create(struct gz_gazepoint_xml **out_xml)
{
	struct gz_gazepoint_xml *xml = calloc(1, sizeof *xml);
	if (!xml)
		return GZ_ERR_NO_MEM;
	/* Where there is no randomness yet, Expat finds its own for a salt of 0. */
	if (getrandom(&xml->salt, sizeof xml->salt, GRND_NONBLOCK) < 0)
		xml->salt = 0;
	*out_xml = xml;
	return GZ_OK;
}

/* A new parser for each text: what one text left behind cannot harm the next, and its memory is
 * bounded. It costs a few microseconds. */
static enum gz_result parse(struct gz_gazepoint_xml *xml, const char *text, size_t size,
			    struct visit *visit)
{
	static const XML_Memory_Handling_Suite memory = { arena_malloc, arena_realloc, arena_free };
	xml->used = 0;
	visit->parser = XML_ParserCreate_MM("UTF-8", &memory, NULL);
	if (!visit->parser)
		return GZ_ERR_PROTOCOL;
	XML_SetHashSalt(visit->parser, xml->salt);
	XML_SetUserData(visit->parser, visit);
	XML_SetStartElementHandler(visit->parser, take_start);
	XML_SetStartDoctypeDeclHandler(visit->parser, refuse_type);
	enum XML_Status status = XML_Parse(visit->parser, text, (int)size, XML_TRUE);
	/* An element that is not closed is one, too: Expat then misses its end only. */
	bool whole =
		status == XML_STATUS_OK || XML_GetErrorCode(visit->parser) == XML_ERROR_NO_ELEMENTS;
	XML_ParserFree(visit->parser);
	return whole && visit->elements == 1 ? GZ_OK : GZ_ERR_PROTOCOL;
}

enum gz_result gz_gazepoint_xml_read(struct gz_gazepoint_xml *xml, const char *text, size_t size,
				     gz_gazepoint_element *on_element, void *user)
{
	struct visit visit = { .on_element = on_element, .user = user };
	if (size > INT32_MAX)
		return GZ_ERR_PROTOCOL;
	parsing = xml;
	enum gz_result result = parse(xml, text, size, &visit);
	parsing = NULL;
	return result;
}

void gz_gazepoint_xml_destroy(struct gz_gazepoint_xml **xml)
{
	if (!xml || !*xml)
		return;
	free(*xml);
	*xml = NULL;
}
