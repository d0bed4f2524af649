# Checks the links between the documents: the file of each relative link is there and not empty, and
# has the heading that the link names. Prints each fault, and at the end how many links there are.
#
# usage: awk -f links.awk FILE.md...

function folder_of(path)
{
	return sub(/[^\/]*$/, "", path) ? path : ""
}

# "docs/a/../b.md" -> "docs/b.md"
function plain_path(path)
{
	while (sub(/[^\/.]+\/\.\.\//, "", path))
		;
	return path
}

# The name by which a link reaches a heading: lower case, without punctuation, "-" for blanks.
function name_of(heading)
{
	gsub(/\[|\]\([^)]*\)/, "", heading)
	heading = tolower(heading)
	gsub(/[!-,.\/:-@\[-^`{-~]/, "", heading)
	sub(/^ +/, "", heading)
	gsub(/ /, "-", heading)
	return heading
}

# Read the headings of a document, once. False if it is not there or empty.
function read_headings(path,    line, code, bytes)
{
	if (path in found)
		return found[path]
	code = bytes = 0
	while ((getline line < path) > 0) {
		bytes += length(line)
		if (line ~ /^```/)
			code = !code
		if (!code && line ~ /^#+ /) {
			sub(/^#+ /, "", line)
			headings[path, name_of(line)] = 1
		}
	}
	close(path)
	return found[path] = bytes > 0
}

function complain(text)
{
	printf "%s:%d: %s\n", FILENAME, FNR, text
	faults++
}

function check_link(target,    path, heading)
{
	links++
	path = heading = target
	sub(/#.*/, "", path)
	if (!sub(/^[^#]*#/, "", heading))
		heading = ""
	path = path == "" ? FILENAME : plain_path(folder_of(FILENAME) path)
	if (!read_headings(path))
		complain(target ": not there, or empty")
	else if (heading != "" && !((path, heading) in headings))
		complain(target ": no such heading")
}

FNR == 1 {
	is_code = 0
}
/^```/ {
	is_code = !is_code
}
!is_code {
	rest = $0
	while (match(rest, /\]\([^)]+\)/)) {
		target = substr(rest, RSTART + 2, RLENGTH - 3)
		rest = substr(rest, RSTART + RLENGTH)
		if (target !~ /^[a-z]+:/)
			check_link(target)
	}
}

END {
	printf "%d links, %d astray\n", links, faults
	exit faults > 0
}
