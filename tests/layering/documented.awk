# Fails if a header declares a function without a comment right before it.
#   awk -f documented.awk header...
# A declaration begins in column 0 and holds "name(" on its first or second line; macros, typedefs
# of function types and inline functions count as well as plain prototypes.
FNR == 1 { before = ""; within = 0 }

within {
	if (/;[ \t]*$/ || /^}/)
		within = 0
	before = ""
	next
}

/^[a-z_].*[a-z0-9_]+\(/ && !/^typedef struct/ && !/^extern "C"/ {
	functions++
	if (before !~ /\*\/[ \t]*$/) {
		name = $0
		gsub(/__attribute__\(\([^;]*\)\)\)? */, "", name)
		sub(/\(.*/, "", name)
		sub(/.*[ *]/, "", name)
		printf "%s:%d: %s has no comment; say what it does, units, errors, threads\n", \
			FILENAME, FNR, name
		faults++
	}
	within = !/;[ \t]*$/
	before = ""
	next
}

/[^ \t]/ { before = $0 }

END {
	if (!functions) {
		print "no function found; this test checks nothing"
		exit 1
	}
	printf "%d functions, %d without a comment\n", functions, faults
	exit faults > 0
}
