# Fails if a header declares a function without a comment right before it. Declarations that follow
# each other without an empty line share the comment before the first.
#   awk -f documented.awk header...
FNR == 1 { covered = 0; within = 0 }

# The rest of a declaration or of an inline function's body.
within {
	if (/;[ \t]*$/ && !body || /^}/)
		within = 0
	next
}

/^[a-z_].*[a-z0-9_]+\(/ && !/^(extern "C"|_Static_assert|static_assert)/ {
	functions++
	if (!covered) {
		name = $0
		gsub(/__attribute__\(\([^;]*\)\)\)? */, "", name)
		sub(/\(.*/, "", name)
		sub(/.*[ *]/, "", name)
		printf "%s:%d: %s has no comment; say what it does, units, errors, threads\n", \
			FILENAME, FNR, name
		faults++
	}
	covered = 2
	within = !/;[ \t]*$/
	body = /^static inline/
	next
}

# A comment on a group of declarations may stand apart from the first.
/^$/ {
	covered = covered == 1
	next
}

{ covered = /\*\/[ \t]*$/ }

END {
	if (!functions) {
		print "no function found; this test checks nothing"
		exit 1
	}
	printf "%d functions, %d without a comment\n", functions, faults
	exit faults > 0
}
