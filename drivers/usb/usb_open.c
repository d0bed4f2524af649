#include "drivers/usb/usb_open.h"

#include <stdio.h>

#define GZ_LOG_MODULE "usb"

/* What is searched for, and what was found so far. */
struct usb_search {
	const struct gz_usb_kind *kind;
	const char *choice;
	const struct gz_log *log;
	struct gz_usb_opened *opened;
	enum gz_result first; /* of the failures; GZ_ERR_NO_DEVICE if there was none */
	int seen;
	bool has_unusable; /* one that was chosen, which is logged */
};

static const struct gz_usb_product *find_usb_product(const struct gz_usb_kind *kind,
						     const struct gz_usb_device *usb)
{
	for (size_t i = 0; i < kind->product_count; i++)
		if (usb->vendor == kind->products[i].vendor &&
		    usb->product == kind->products[i].product)
			return &kind->products[i];
	return NULL;
}

/* @return the product, or NULL if the device is of another kind */
static const struct gz_usb_product *describe_usb_product(const struct gz_usb_kind *kind,
							 libusb_device *device,
							 struct gz_usb_device *out_usb)
{
	gz_usb_describe(device, out_usb);
	const struct gz_usb_product *product = find_usb_product(kind, out_usb);
	if (product && (!product->is_named || !out_usb->name[0]))
		snprintf(out_usb->name, sizeof out_usb->name, "%s", product->name);
	return product;
}

static enum gz_result refuse_usb_device(const struct gz_usb_device *usb, const struct gz_log *log,
					const char *what, int error)
{
	enum gz_result result = gz_usb_result(error);
	switch (result) {
	case GZ_ERR_ACCESS:
		gz_err(log, "%s at %s: no permission for %s; %s", usb->name, usb->place, usb->node,
		       GZ_DEVICE_PERMISSION_REMEDY);
		return result;
	case GZ_ERR_BUSY:
		gz_err(log, "%s at %s: another program uses its eye tracker; close that program",
		       usb->name, usb->place);
		return result;
	default:
		gz_err(log, "%s at %s: cannot %s: %s; plug it in again", usb->name, usb->place,
		       what, libusb_error_name(error));
		return result;
	}
}

static void close_usb_handle(struct gz_usb_opened *opened)
{
	if (opened->is_claimed)
		libusb_release_interface(opened->handle, opened->interface_number);
	if (opened->handle)
		libusb_close(opened->handle);
	opened->is_claimed = false;
	opened->handle = NULL;
}

void gz_usb_close(struct gz_usb_opened *opened)
{
	close_usb_handle(opened);
	if (opened->context)
		libusb_exit(opened->context);
	opened->context = NULL;
}

static enum gz_result open_usb_device(struct gz_usb_opened *opened, libusb_device *device,
				      const struct gz_log *log)
{
	int error = libusb_open(device, &opened->handle);
	if (error != LIBUSB_SUCCESS) {
		opened->handle = NULL;
		return refuse_usb_device(&opened->usb, log, "open it", error);
	}
	/* Not supported everywhere, and needed only if a kernel driver uses the interface. */
	libusb_set_auto_detach_kernel_driver(opened->handle, 1);
	error = libusb_claim_interface(opened->handle, opened->interface_number);
	if (error == LIBUSB_SUCCESS) {
		opened->is_claimed = true;
		return GZ_OK;
	}
	enum gz_result result = refuse_usb_device(&opened->usb, log, "claim its interface", error);
	close_usb_handle(opened);
	return result;
}

/* Open one device of the bus, if it is what is searched for. */
static void try_usb_device(struct usb_search *search, libusb_device *device)
{
	struct gz_usb_device usb;
	const struct gz_usb_product *product = describe_usb_product(search->kind, device, &usb);
	if (!product)
		return;
	search->seen++;
	if (search->opened->handle || !gz_device_is_chosen(search->choice, usb.name, usb.serial)) {
		gz_info(search->log, "not used: %s %s at %s", usb.name, usb.serial, usb.place);
		return;
	}
	if (product->unusable) {
		gz_err(search->log, "%s at %s: %s", usb.name, usb.place, product->unusable);
		search->has_unusable = true;
		return;
	}
	search->opened->usb = usb;
	enum gz_result result = open_usb_device(search->opened, device, search->log);
	if (result != GZ_OK && search->first == GZ_ERR_NO_DEVICE)
		search->first = result;
}

static enum gz_result open_first_usb_device(struct usb_search *search, libusb_device *const *list)
{
	for (size_t i = 0; list[i]; i++)
		try_usb_device(search, list[i]);
	if (search->opened->handle)
		return GZ_OK;
	if (search->seen == 0)
		gz_err(search->log, "no %s on USB; plug one in", search->kind->name);
	else if (search->first == GZ_ERR_NO_DEVICE && !search->has_unusable)
		gz_err(search->log, "no %s is called %s; see gazectl devices", search->kind->name,
		       search->choice ? search->choice : "");
	return search->first;
}

enum gz_result gz_usb_open(const struct gz_usb_kind *kind, const char *choice,
			   const struct gz_log *log, struct gz_usb_opened *out_opened)
{
	libusb_device **list;
	*out_opened = (struct gz_usb_opened) { .interface_number = kind->interface_number };
	int error = libusb_init(&out_opened->context);
	if (error != LIBUSB_SUCCESS) {
		out_opened->context = NULL;
		gz_err(log, "cannot access USB: %s", libusb_error_name(error));
		return gz_usb_result(error);
	}
	ssize_t count = libusb_get_device_list(out_opened->context, &list);
	if (count < 0) {
		gz_err(log, "cannot list USB devices: %s", libusb_error_name((int)count));
		return gz_usb_result((int)count);
	}
	struct usb_search search = { kind, choice, log, out_opened, GZ_ERR_NO_DEVICE, 0, false };
	enum gz_result result = open_first_usb_device(&search, list);
	libusb_free_device_list(list, 1);
	return result;
}

static void list_usb_product(const struct gz_usb_product *product, const struct gz_usb_device *usb,
			     int interface_number, struct gz_device_entry *out_entry)
{
	gz_usb_list_entry(usb, interface_number, out_entry);
	if (!product->unusable)
		return;
	out_entry->usable = false;
	snprintf(out_entry->reason, sizeof out_entry->reason, "%s", product->unusable);
}

size_t gz_usb_list(const struct gz_usb_kind *kind, const struct gz_log *log,
		   struct gz_device_entry *out_entries)
{
	libusb_context *context;
	libusb_device **list;
	size_t count = 0;
	int error = libusb_init(&context);
	if (error != LIBUSB_SUCCESS) {
		gz_warn(log, "cannot access USB: %s", libusb_error_name(error));
		return 0;
	}
	if (libusb_get_device_list(context, &list) >= 0) {
		for (size_t i = 0; list[i] && count < GZ_DEVICE_ENTRIES_MAX; i++) {
			struct gz_usb_device usb;
			const struct gz_usb_product *product =
				describe_usb_product(kind, list[i], &usb);
			if (product)
				list_usb_product(product, &usb, kind->interface_number,
						 &out_entries[count++]);
		}
		libusb_free_device_list(list, 1);
	}
	libusb_exit(context);
	return count;
}
