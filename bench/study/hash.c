#include "bench/study/hash.h"

#include <openssl/evp.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct gz_hash {
	EVP_MD_CTX *context;
	bool failed;
};

enum gz_result gz_hash_begin(struct gz_hash **out_hash)
{
	struct gz_hash *hash = calloc(1, sizeof *hash);
	if (!hash)
		return GZ_ERR_NO_MEM;
	hash->context = EVP_MD_CTX_new();
	if (!hash->context || EVP_DigestInit_ex(hash->context, EVP_sha256(), NULL) != 1) {
		gz_hash_end(&hash, NULL);
		return GZ_ERR_NO_MEM;
	}
	*out_hash = hash;
	return GZ_OK;
}

void gz_hash_add(struct gz_hash *hash, const void *bytes, size_t size)
{
	if (EVP_DigestUpdate(hash->context, bytes, size) != 1)
		hash->failed = true;
}

void gz_hash_add_text(struct gz_hash *hash, const char *text)
{
	gz_hash_add(hash, text, strlen(text) + 1);
}

void gz_hash_add_number(struct gz_hash *hash, double number)
{
	uint64_t bits;
	unsigned char bytes[8];
	memcpy(&bits, &number, sizeof bits);
	for (int i = 0; i < 8; i++)
		bytes[i] = (unsigned char)(bits >> (8 * i));
	gz_hash_add(hash, bytes, sizeof bytes);
}

void gz_hash_add_options(struct gz_hash *hash, const struct gz_option *options, size_t count,
			 const void *target)
{
	char text[GZ_PATH_SIZE];
	for (size_t i = 0; i < count; i++) {
		gz_hash_add_text(hash, options[i].key);
		if (gz_option_format(&options[i], target, text, sizeof text) == GZ_OK)
			gz_hash_add_text(hash, text);
	}
}

void gz_hash_add_rays(struct gz_hash *hash, const struct gz_ray_params *rays)
{
	struct gz_ray_params copy = *rays;
	struct gz_option_binding bindings[GZ_RAY_BINDINGS];
	gz_ray_params_bind(&copy, bindings);
	for (size_t i = 0; i < GZ_RAY_BINDINGS; i++)
		gz_hash_add_options(hash, bindings[i].options, bindings[i].count,
				    bindings[i].target);
}

enum gz_result gz_hash_end(struct gz_hash **hash, char out_hex[GZ_STUDY_HASH_SIZE])
{
	static const char digits[] = "0123456789abcdef";
	unsigned char bytes[EVP_MAX_MD_SIZE];
	if (!*hash)
		return GZ_OK;
	const bool failed = (*hash)->failed || !out_hex ||
			    EVP_DigestFinal_ex((*hash)->context, bytes, NULL) != 1;
	for (int i = 0; i < 32 && !failed; i++) {
		out_hex[2 * i] = digits[bytes[i] >> 4];
		out_hex[2 * i + 1] = digits[bytes[i] & 15];
	}
	if (!failed)
		out_hex[64] = '\0';
	EVP_MD_CTX_free((*hash)->context);
	free(*hash);
	*hash = NULL;
	return failed && out_hex ? GZ_ERR_NO_MEM : GZ_OK;
}
