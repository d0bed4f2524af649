# Copies a manual page and puts lists of options where it asks for them, by a line
#   @options FILE WHICH
# FILE is what a program prints for --help: lines "  --key VALUE  text". WHICH is "plain" for keys
# without a dot, or "dotted" for the others, a subsection for each part before the dot.

function escaped(text) {
	gsub(/\\/, "\\e", text)
	gsub(/…/, "...", text)
	gsub(/"/, "\\(dq", text)
	return text
}

# "--key VALUE" as the heading of an item.
function heading(key, value, dotted) {
	gsub(/'/, "", value)
	text = dotted ? ".It Ic " key : ".It Fl -" key
	return value == "" ? text : text " Ar \"" escaped(value) "\""
}

function begin_list() {
	print ".Bl -tag -width Ds"
	open = 1
}

function end_list() {
	if (open)
		print ".El"
	open = 0
}

function put_option(line, which,    gap, left, help, key, value, section) {
	sub(/^  --/, "", line)
	gap = match(line, /  +/)
	left = substr(line, 1, gap - 1)
	help = substr(line, gap)
	sub(/^ +/, "", help)
	key = left
	sub(/ .*/, "", key)
	value = left
	if (!sub(/^[^ ]+ /, "", value))
		value = ""
	if ((index(key, ".") > 0) != (which == "dotted"))
		return
	section = key
	sub(/\..*/, "", section)
	if (which == "dotted" && section != last_section) {
		end_list()
		print ".Ss [" section "]"
		last_section = section
	}
	if (!open)
		begin_list()
	if (which == "dotted") { # a key of a file, whose value stands behind "="
		sub(/^[^.]*\./, "", key)
		sub(/; --[^ ]*=no switches it off\)/, ")", help)
	}
	print heading(key, value, which == "dotted")
	print escaped(toupper(substr(help, 1, 1)) substr(help, 2)) "."
	seen++
}

$1 == "@options" {
	seen = 0
	last_section = ""
	while ((status = (getline line < $2)) > 0)
		if (line ~ /^  --/)
			put_option(line, $3)
	close($2)
	end_list()
	if (status < 0 || seen == 0) {
		print FILENAME ":" FNR ": no " $3 " options in " $2 > "/dev/stderr"
		exit 1
	}
	next
}

# A line "@example FILE" becomes the file's text.
$1 == "@example" {
	while ((status = (getline line < $2)) > 0) {
		gsub(/\\/, "\\e", line)
		print line
	}
	if (status < 0) {
		print FILENAME ":" FNR ": cannot read " $2 > "/dev/stderr"
		exit 1
	}
	next
}

{ print }
