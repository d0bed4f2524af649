/**
 * @file
 * The thread that serves samples. It reads the tracker, runs each sample through the pipeline,
 * publishes the results, hands the sample to the recorder, and carries out commands from the
 * requests' thread.
 */
#ifndef GZ_DAEMON_SERVICE_H
#define GZ_DAEMON_SERVICE_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "daemon/config.h"
#include "daemon/inlet.h"
#include "daemon/lsl/lsl_outlet.h"
#include "daemon/process.h"
#include "daemon/publisher.h"
#include "daemon/recorder.h"
#include "drivers/pointer/pointer_driver.h"
#include "protocol/gaze.h"
#include "protocol/gaze_log.h"
#include "protocol/validated_file.h"

/*
 * Messages between this thread and the requests' thread, over a pair of inproc sockets. Each
 * message is one of these structs, as it lies in memory: both threads are in one process.
 */

/** The inproc endpoint of the pair; the requests' thread binds it. */
#define GZ_COMMAND_ENDPOINT "inproc://command"

/** Commands to the thread that serves samples. */
enum gz_command_kind {
	GZ_COMMAND_RECORD,  /**< begin a recording into fd and path */
	GZ_COMMAND_STOP,    /**< end the recording */
	GZ_COMMAND_CORRECT, /**< read the stored correction again; it may have changed */
	GZ_COMMAND_SEND,    /**< send a message on the stream, whose body is in the frame after this
			       struct; if has_mark, write text into the gaze log */
	GZ_COMMAND_WINDOW,  /**< a viewer's window has moved or is closed */
	GZ_COMMAND_QUIT,
};

/** A command. */
struct gz_command {
	enum gz_command_kind kind;
	uint32_t number;                /**< RECORD, STOP, CORRECT: repeated in the answer */
	int fd;                         /**< RECORD: owned by the receiver, unless it refuses */
	int64_t host_ns;                /**< SEND with a mark, WINDOW */
	bool has_mark;                  /**< SEND */
	struct gz_viewer_window window; /**< WINDOW; its time is host_ns */
	char path[GZ_PATH_SIZE];
	char topic[GZ_INLET_TOPIC_SIZE];  /**< SEND */
	char text[GZ_GAZE_LOG_TEXT_SIZE]; /**< SEND with a mark */
	int64_t duration_ns;              /**< SEND with a mark */
	char keys[GZ_GAZE_LOG_KEYS_SIZE]; /**< SEND with a mark */
};

/** Notices to the requests' thread. */
enum gz_notice_kind {
	GZ_NOTICE_ANSWER, /**< answers the command with this number */
	GZ_NOTICE_FAILED, /**< the service cannot continue and has ended; it was logged */
	GZ_NOTICE_ENDED,  /**< a replay is over, and its recording, if any, is being finished */
};

/** A notice. */
struct gz_notice {
	enum gz_notice_kind kind;
	uint32_t number;
	enum gz_result result;
};

/*
 * The service.
 */

/** Longest wait for a sample before commands are read, ms. Chosen: a request is answered well
 * within 100 ms. */
#define GZ_SERVICE_WAIT_MS 10

/** How often commands are read while samples come, ms. Chosen: reading costs a system call, which
 * would be too much for every sample of a fast tracker. */
#define GZ_SERVICE_COMMANDS_MS 5

/** The same while more of them wait, ms. Chosen: together with the commands that are taken at once
 * (service.c), 16 000 messages of clients a second, which readers can still follow. */
#define GZ_SERVICE_HURRY_MS 1

/** How often connections and states are checked, ms. */
#define GZ_SERVICE_CARE_MS 50

/** Longest time between two status messages, ms. */
#define GZ_SERVICE_STATUS_MS 1000

/** What a service works with; all borrowed, and used by nobody else until it is destroyed. */
struct gz_service_parts {
	const struct gz_config *config;
	void *context; /**< ZeroMQ; GZ_COMMAND_ENDPOINT is bound in it */
	struct gz_publisher *publisher;
	struct gz_recorder *recorder;
	struct gz_lsl_outlet *lsl;       /**< NULL: no outlet to the Lab Streaming Layer */
	struct gz_pointer_feed *pointer; /**< lent to the driver */
	const struct gz_guard *guard;    /**< for its counts */
	const struct gz_inlet_counts *inlet_counts;
	struct gz_notify *notify; /**< told that samples are served */
	const struct gz_log *log;
};

/** A service. */
struct gz_service;

/**
 * Create a service and open the tracker.
 *
 * @param parts             copied; what it points to is borrowed
 * @param[out] out_service  owned by the caller: gz_service_destroy()
 * @retval GZ_ERR_NO_MEM  no memory
 * @return else a result after one logged line: the tracker's settings cannot work
 */
enum gz_result gz_service_create(const struct gz_service_parts *parts,
				 struct gz_service **out_service);

/**
 * Begin a recording. Call it before gz_service_start(); once the thread runs, send
 * GZ_COMMAND_RECORD instead.
 *
 * @param fd    as for gz_recorder_start()
 * @param path  of the file
 * @return as gz_recorder_start()
 */
enum gz_result gz_service_record(struct gz_service *service, int fd, const char *path);

/**
 * Start the thread. It runs until it gets GZ_COMMAND_QUIT.
 *
 * @retval GZ_ERR_IO      no socket for commands; logged
 * @retval GZ_ERR_NO_MEM  no thread; logged
 */
enum gz_result gz_service_start(struct gz_service *service);

/** Wait for the thread to end if it was started, free the service and set *service to NULL. Accepts
 * a pointer to NULL. */
void gz_service_destroy(struct gz_service **service);

#endif
