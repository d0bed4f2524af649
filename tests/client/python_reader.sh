#!/bin/sh
# usage: python_reader.sh READER PUBLISHER
# The Python reader of docs/ finds a publisher by its endpoint and by the runtime directory, and
# prints what it sends.
set -eu
reader=$1 publisher=$2 python=/usr/bin/python3
"$python" -c 'import msgpack, zmq' 2>/dev/null || { echo "no python3-zmq, python3-msgpack"; exit 77; }
place=$(mktemp -d /tmp/gazecast-python-XXXXXX)
publisher_id=
trap '[ -z "$publisher_id" ] || kill "$publisher_id"; rm -rf "$place"' EXIT
mkdir "$place/gazecast"
"$publisher" "ipc://$place/gazecast/latest" &
publisher_id=$!

expect() {
	cat "$place/out"
	[ "$(head -n 3 "$place/out" | grep -c 'x 0\.250  y 0\.750  fixation$')" -eq 3 ]
}
timeout "${GZ_TEST_PATIENCE_S:-60}" "$python" "$reader" "ipc://$place/gazecast/latest" 3 >"$place/out"
expect
# The reader runs until it is stopped: head ends it by closing the pipe.
unset GAZECAST_RUNTIME_DIR
XDG_RUNTIME_DIR=$place timeout "${GZ_TEST_PATIENCE_S:-60}" "$python" "$reader" 2>/dev/null | head -n 3 >"$place/out"
expect
