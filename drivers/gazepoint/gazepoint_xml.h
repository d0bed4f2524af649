/**
 * @file
 * One XML element out of a short text, by Expat within a fixed piece of memory: whatever the text
 * claims, Expat gets GZ_GAZEPOINT_XML_ARENA bytes and no more, and malloc() is not called. Document
 * types are refused, so there are no entities but the five of XML itself.
 */
#ifndef GZ_DRIVERS_GAZEPOINT_XML_H
#define GZ_DRIVERS_GAZEPOINT_XML_H

#include <stddef.h>

#include "base/result.h"

/** Bytes that Expat may use for one text. Chosen: a text of 4 KiB of the shortest attributes takes
 * about 100 KiB with Expat 2.5. */
#define GZ_GAZEPOINT_XML_ARENA (256 * 1024)

/** Memory to parse in; reused for one text after the other. */
struct gz_gazepoint_xml;

/**
 * Make the memory.
 *
 * @retval GZ_ERR_NO_MEM  no room
 */
enum gz_result gz_gazepoint_xml_create(struct gz_gazepoint_xml **out_xml);

/**
 * Receives the element.
 *
 * @param name        of the element
 * @param attributes  name, value, name, value, …, NULL; values with their entities replaced; valid
 *                    during the call only
 */
typedef void gz_gazepoint_element(void *user, const char *name, const char *const *attributes);

/**
 * Read the one element that @p text is, empty or not closed. Does not allocate.
 *
 * @param text, size  untrusted
 * @retval GZ_OK            @p on_element was called once
 * @retval GZ_ERR_PROTOCOL  anything else than one element, a document type, or more than fits into
 *                          the memory; @p on_element may have been called
 *
 * Threads: one at a time for each @p xml.
 */
enum gz_result gz_gazepoint_xml_read(struct gz_gazepoint_xml *xml, const char *text, size_t size,
				     gz_gazepoint_element *on_element, void *user);

/** Free and set to NULL. Accepts a pointer to NULL. */
void gz_gazepoint_xml_destroy(struct gz_gazepoint_xml **xml);

#endif
