# Source this: a picture of a scene with every pixel a ray beside the same one foveated, with two
# places enlarged, at the gaze and beside it. Needs ffmpeg and jq.

# The edges of the pictures and of what is enlarged, px.
side_by_side_edge=1024
side_by_side_crop=120
side_by_side_font=/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf

# frame_place X Y COLOUR : an ffmpeg filter that frames a place.
frame_place() {
	local crop=$side_by_side_crop
	printf 'drawbox=x=%d:y=%d:w=%d:h=%d:t=3:color=%s' $(($1 - crop / 2)) $(($2 - crop / 2)) \
		$crop $crop "$3"
}

# enlarge_place X Y COLOUR : an ffmpeg filter that shows a place alone.
enlarge_place() {
	local crop=$side_by_side_crop
	printf 'crop=%d:%d:%d:%d,scale=304:304:flags=neighbor,' $crop $crop $(($1 - crop / 2)) \
		$(($2 - crop / 2))
	printf 'drawbox=w=iw:h=ih:t=4:color=%s,pad=312:312:4:4:color=0x14161a' "$3"
}

# write_above TEXT : an ffmpeg filter that writes above the picture.
write_above() {
	printf "pad=iw:ih+40:0:40:color=0x14161a,drawtext=fontfile=%s:text='%s'" \
		"$side_by_side_font" "$1"
	printf ":x=10:y=10:fontsize=20:fontcolor=0xe8e6e3"
}

# side_by_side FILE FOLDER GAZE_X GAZE_Y OTHER_X OTHER_Y GAZEVIEW ARGUMENT... : writes a picture of
# what gazeview shows with these arguments. Both places are in px of a picture of 1024 x 1024; what
# is made on the way goes to the folder.
side_by_side() {
	local file=$1 folder=$2 gaze=("$3" "$4") other=("$5" "$6") edge=$side_by_side_edge
	local gazeview=$7 at_gaze=0xffd166 beside=0x6bd5ff method i graph="" rays=()
	shift 7
	for method in standard acuity; do
		"$gazeview" --headless --backend cpu --method "$method" --size "${edge}x$edge" \
			--gaze "$(jq -nr "\"\(${gaze[0]} / $edge),\(${gaze[1]} / $edge)\"")" "$@" \
			--stats "$folder/$method.json" --out "$folder/$method.png" >/dev/null || return
		rays+=("$(jq '.frames[0].rays' "$folder/$method.json")")
	done
	for i in 0 1; do
		graph+="[$i]format=gbrp,split=3[w$i][g$i][r$i];"
		graph+="[w$i]$(frame_place "${gaze[@]}" $at_gaze),$(frame_place "${other[@]}" $beside),"
		graph+="scale=616:616:flags=area,pad=624:624:4:4:color=0x14161a[p$i];"
		graph+="[g$i]$(enlarge_place "${gaze[@]}" $at_gaze)[a$i];"
		graph+="[r$i]$(enlarge_place "${other[@]}" $beside)[b$i];"
		graph+="[a$i][b$i]hstack[c$i];[p$i][c$i]vstack[q$i];"
	done
	graph+="[q0]$(write_above "every pixel a ray · ${rays[0]} rays")[l];"
	graph+="[q1]$(write_above "as sharp as the eye · ${rays[1]} rays")[m];[l][m]hstack"
	local codec=()
	[ "${file##*.}" != webp ] || codec=(-c:v libwebp -quality 82)
	ffmpeg -v error -y -i "$folder/standard.png" -i "$folder/acuity.png" -filter_complex "$graph" \
		"${codec[@]}" -frames:v 1 "$file"
}
