#include "client/client.h"

#include <stdlib.h>
#include <zmq.h>

#include "base/clock.h"
#include "client/connection.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "client"

/* Chosen, see gz_gaze_age_ns() in the header. */
#define PIPELINE_DELAY_MAX_NS GZ_NS_PER_S

struct gz_client {
	struct gz_subscriber subscriber;
	bool has_gaze;
	struct gz_gaze gaze;
	struct gz_client_counters counters;
	struct gz_ratelimit malformed_limit;
};

static enum gz_result open_client(const struct gz_subscriber_params *params,
				  const struct gz_log *log, struct gz_client **out_client)
{
	struct gz_client *client = calloc(1, sizeof *client);
	if (!client)
		return GZ_ERR_NO_MEM;
	enum gz_result result = gz_subscriber_open(&client->subscriber, params, log);
	if (result != GZ_OK) {
		gz_client_close(&client);
		return result;
	}
	*out_client = client;
	return GZ_OK;
}

enum gz_result gz_client_open(const char *endpoint, const struct gz_log *log,
			      struct gz_client **out_client)
{
	const struct gz_subscriber_params params = {
		.endpoint = endpoint,
		.channel = "latest",
		.conflate = true,
		.find_keys = true,
	};
	return open_client(&params, log, out_client);
}

enum gz_result gz_client_open_with_keys(const char *endpoint, const struct gz_keys *keys,
					const struct gz_log *log, struct gz_client **out_client)
{
	const struct gz_subscriber_params params = {
		.endpoint = endpoint,
		.channel = "latest",
		.conflate = true,
		.keys = keys,
	};
	return open_client(&params, log, out_client);
}

static void count_malformed_gaze(struct gz_client *client)
{
	uint64_t dropped;
	client->counters.malformed++;
	if (gz_ratelimit_pass(&client->malformed_limit, gz_clock_now_ns(), GZ_NS_PER_S, &dropped))
		gz_warn(client->subscriber.log,
			"%s: a message is not gaze (%llu so far); is this a `latest` channel?",
			client->subscriber.endpoint,
			(unsigned long long)client->counters.malformed);
}

static void keep_newest_gaze(struct gz_client *client, const struct gz_gaze *gaze)
{
	/* A smaller number means that the daemon or a replay has started again. */
	if (client->has_gaze && gaze->seq > client->gaze.seq)
		client->counters.skipped += gaze->seq - client->gaze.seq - 1;
	client->gaze = *gaze;
	client->has_gaze = true;
}

static void take_latest(struct gz_client *client, const void *bytes, size_t size)
{
	struct gz_gaze gaze;
	client->counters.received++;
	if (gz_wire_decode_gaze(bytes, size, &gaze) == GZ_OK)
		keep_newest_gaze(client, &gaze);
	else
		count_malformed_gaze(client);
}

static void receive_latest_from_socket(struct gz_client *client)
{
	zmq_msg_t message;
	zmq_msg_init(&message);
	/* A conflated socket holds one message at most. */
	if (zmq_msg_recv(&message, client->subscriber.socket, ZMQ_DONTWAIT) >= 0)
		take_latest(client, zmq_msg_data(&message), zmq_msg_size(&message));
	zmq_msg_close(&message);
}

static void receive_latest(struct gz_client *client)
{
	struct gz_board_link *board = &client->subscriber.board;
	struct gz_board_reader *reader = gz_board_link_reader(board);
	struct gz_board_record record;
	enum gz_result result = reader ? gz_board_newest(reader, &record) : GZ_ERR_TIMEOUT;
	if (result == GZ_OK)
		take_latest(client, record.body, record.body_size);
	else if (result == GZ_ERR_PROTOCOL)
		gz_board_link_give_up(board);
	else if (gz_board_link_reads_socket(board))
		receive_latest_from_socket(client);
}

int64_t gz_gaze_age_ns(const struct gz_gaze *gaze, int64_t now_ns)
{
	int64_t born_ns = gaze->host_ns;
	/* Pupil Capture sends no publish time; then only the sample's own is known. */
	if (gaze->publish_ns > 0 && (gaze->publish_ns < gaze->host_ns ||
				     gaze->host_ns < gaze->publish_ns - PIPELINE_DELAY_MAX_NS))
		born_ns = gaze->publish_ns;
	if (born_ns < 0) /* before this machine started, so not by its clock */
		born_ns = 0;
	return born_ns < now_ns ? now_ns - born_ns : 0;
}

enum gz_result gz_client_latest(struct gz_client *client, struct gz_gaze *out_gaze,
				int64_t *out_age_ns)
{
	receive_latest(client);
	gz_subscriber_take_events(&client->subscriber);
	if (!client->has_gaze)
		return GZ_ERR_TIMEOUT;
	*out_gaze = client->gaze;
	if (out_age_ns)
		*out_age_ns = gz_gaze_age_ns(&client->gaze, gz_clock_now_ns());
	return GZ_OK;
}

void gz_client_get_counters(struct gz_client *client, struct gz_client_counters *out_counters)
{
	gz_subscriber_take_events(&client->subscriber);
	client->counters.connected = client->subscriber.connected;
	client->counters.connections = client->subscriber.connections;
	*out_counters = client->counters;
}

const char *gz_client_endpoint(const struct gz_client *client)
{
	return client->subscriber.endpoint;
}

void gz_client_close(struct gz_client **client)
{
	if (!*client)
		return;
	gz_subscriber_close(&(*client)->subscriber);
	free(*client);
	*client = NULL;
}
