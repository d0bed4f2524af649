# Completions of one program for a shell, from what it prints for --help.
#   awk -v shell=bash|zsh|fish -v program=gazectl -f completions.awk gazectl.help gazectl-convert.help ...
# The file PROGRAM.help has the program's own options and commands, PROGRAM-COMMAND.help a command's options.

# The allowed words of a choice, of "... (off, loopback or curve; default off)", separated by blanks.
function choices_of(help,    list) {
	if (!match(help, /\([^()]*\)$/))
		return ""
	list = substr(help, RSTART + 1, RLENGTH - 2)
	sub(/; default [^;]*$/, "", list)
	sub(/^.*; /, "", list)
	gsub(/ or /, " ", list)
	gsub(/,/, "", list)
	return list
}

function note_option(line,    gap, left, parts) {
	sub(/^  --/, "", line)
	gap = match(line, /  +/)
	left = substr(line, 1, gap - 1)
	split(left, parts, " ")
	count++
	owner[count] = command
	key[count] = parts[1]
	kind[count] = left ~ / / ? parts[2] : ""
	help[count] = substr(line, gap)
	sub(/^ +/, "", help[count])
	words[count] = kind[count] == "NAME" ? choices_of(help[count]) : ""
}

function note_command(line,    parts) {
	split(line, parts, " ")
	commands++
	command_name[commands] = parts[1]
	sub(/^[^ ]+ +/, "", line)
	sub(/^.*  +/, "", line) # its operands
	command_help[commands] = line
}

FNR == 1 {
	command = FILENAME
	sub(/^.*\//, "", command)
	sub(/\.help$/, "", command)
	sub("^" program "-?", "", command)
	in_commands = 0
}
/^commands:/ { in_commands = 1; next }
/^$/ { in_commands = 0 }
in_commands && /^  [a-z]/ { note_command(substr($0, 3)) }
/^  --[a-z]/ { note_option($0) }

# The first sentence, which a menu has room for.
function brief(text) {
	sub(/ \([^()]*\)$/, "", text)
	sub(/[;:] .*$/, "", text)
	return text
}

# Within single quotes of a shell.
function quoted(text) {
	gsub(/'/, "'\\''", text)
	return "'" text "'"
}

function fish_quoted(text) {
	gsub(/\\/, "\\\\", text)
	gsub(/'/, "\\'", text)
	return "'" text "'"
}

# Within an item of zsh's _arguments: [text] and parts between colons.
function zsh_text(text) {
	gsub(/\\/, "\\\\", text)
	gsub(/\[/, "\\[", text)
	gsub(/\]/, "\\]", text)
	gsub(/:/, "\\:", text)
	return text
}

function put_bash(    i, last, name) {
	name = "_" program
	print "# Completion of " program " for bash, made from its table of options."
	print name "_options() {\n\tcase $1 in"
	for (i = 0; i <= commands; i++)
		put_bash_options(i == 0 ? "" : command_name[i])
	print "\tesac\n}"
	print name "_choices() {\n\tcase $1 in"
	for (i = 1; i <= count; i++)
		if (words[i] != "")
			print "\t" quoted(owner[i] "--" key[i]) ") echo " quoted(words[i]) " ;;"
	print "\t*) return 1 ;;\n\tesac\n}"
	print name "() {"
	print "\tlocal current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command= words"
	print "\tif [[ $current == = ]]; then"
	print "\t\tcurrent="
	print "\telif [[ $before == = ]]; then"
	print "\t\tbefore=${COMP_WORDS[COMP_CWORD - 2]}"
	print "\tfi"
	if (commands) {
		print "\t((COMP_CWORD > 1)) && command=${COMP_WORDS[1]}"
		for (i = 1; i <= commands; i++)
			last = last (i > 1 ? " " : "") command_name[i]
	}
	print "\tif words=$(" name "_choices \"$command$before\"); then"
	print "\t\tCOMPREPLY=($(compgen -W \"$words\" -- \"$current\"))"
	print "\telif [[ $current == -* ]]; then"
	print "\t\tCOMPREPLY=($(compgen -W \"$(" name "_options \"$command\")\" -- \"$current\"))"
	if (commands) {
		print "\telif ((COMP_CWORD == 1)); then"
		print "\t\tCOMPREPLY=($(compgen -W " quoted(last) " -- \"$current\"))"
	}
	print "\telse\n\t\tCOMPREPLY=($(compgen -f -- \"$current\"))\n\tfi\n}"
	print "complete -o filenames -F " name " " program
}

function put_bash_options(whose,    i, list) {
	for (i = 1; i <= count; i++)
		if (owner[i] == whose)
			list = list (list == "" ? "" : " ") "--" key[i]
	print "\t" quoted(whose) ") echo " quoted(list) " ;;"
}

function zsh_item(i,    item) {
	item = "--" key[i] "[" zsh_text(brief(help[i])) "]"
	if (words[i] != "")
		item = item ":" kind[i] ":(" words[i] ")"
	else if (kind[i] == "TEXT")
		item = item ":" kind[i] ":_files"
	else if (kind[i] != "") {
		sub(/'.*$/, "", kind[i])
		item = item ":" (kind[i] == "" ? "N" : kind[i]) ": "
	}
	return quoted(item)
}

function put_zsh_arguments(whose, indent,    i) {
	print indent "_arguments -S \\"
	for (i = 1; i <= count; i++)
		if (owner[i] == whose)
			print indent "\t" zsh_item(i) " \\"
	print indent "\t'*:file:_files'"
}

function put_zsh(    i) {
	print "#compdef " program
	print "# Completion of " program " for zsh, made from its table of options."
	if (!commands) {
		put_zsh_arguments("", "")
		return
	}
	print "local -a commands=("
	for (i = 1; i <= commands; i++)
		print "\t" quoted(command_name[i] ":" command_help[i])
	print ")"
	print "if ((CURRENT == 2)); then"
	print "\t_describe command commands"
	print "\treturn"
	print "fi"
	print "local command=$words[2]"
	print "shift words"
	print "((CURRENT--))"
	print "case $command in"
	for (i = 1; i <= commands; i++) {
		print command_name[i] ")"
		put_zsh_arguments(command_name[i], "\t")
		print "\t;;"
	}
	print "esac"
}

function put_fish(    i, when) {
	print "# Completion of " program " for fish, made from its table of options."
	for (i = 1; i <= commands; i++)
		print "complete -c " program " -n __fish_use_subcommand -f -a " command_name[i] " -d " \
			fish_quoted(command_help[i])
	for (i = 1; i <= count; i++) {
		when = ""
		if (commands)
			when = owner[i] == "" ? " -n __fish_use_subcommand" : \
				" -n '__fish_seen_subcommand_from " owner[i] "'"
		print "complete -c " program when " -l " key[i] \
			(words[i] != "" ? " -x -a " fish_quoted(words[i]) : \
			 kind[i] == "" ? "" : kind[i] == "TEXT" ? " -r" : " -x") \
			" -d " fish_quoted(brief(help[i]))
	}
}

END {
	if (count == 0) {
		print program ": no options in its help" > "/dev/stderr"
		exit 1
	}
	if (shell == "bash")
		put_bash()
	else if (shell == "zsh")
		put_zsh()
	else
		put_fish()
}
