# A value at each place of the gaze, over the picture that was looked at.
# data.tsv: x, y, value; picture.png: the picture, dimmed, if has_picture.
load 'common.gp'
set label 1 title_text at screen (1.0 * left / width), screen (1 - 0.5 * top / height) left \
	textcolor rgb ink
unset border
unset tics
unset grid
set xrange [0:picture_width]
set yrange [picture_height:0]
# Viridis (van der Walt and Smith 2015), at every eighth.
set palette defined (0 '#440154', 0.125 '#472d7b', 0.25 '#3b528b', 0.375 '#2c728e', \
	0.5 '#21918c', 0.625 '#28ae80', 0.75 '#5ec962', 0.875 '#addc30', 1 '#fde725')
set cbrange [value_first:value_last]
set colorbox horizontal user origin screen (1.0 * left / width), screen (0.55 * bottom / height) \
	size screen (1 - 1.0 * (left + right) / width), screen (0.25 * bottom / height) noborder
set cbtics value_step scale 0.3 offset 0, 0.3 textcolor rgb mute
set format cb '%g'
set object 1 rectangle from graph 0, 0 to graph 1, 1 fillstyle solid noborder \
	fillcolor rgb '#16181c' behind
if (has_picture) {
	plot 'picture.png' binary filetype=png \
			dx=picture_dx dy=picture_dy origin=(0.5 * picture_dx, 0.5 * picture_dy) \
			flipy with rgbimage, \
		'data.tsv' using 1:2 with points pointtype 7 pointsize 1.25 * point_size \
			linecolor rgb '#000000', \
		'' using 1:2:3 with points pointtype 7 pointsize point_size linecolor palette
} else {
	plot 'data.tsv' using 1:2:3 with points pointtype 7 pointsize point_size linecolor palette
}
