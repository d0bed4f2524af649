# Curves with labels at their points: error over time, and time over what grows.
# data.tsv, by its blocks: 0 the front, 1 lines, 2 points, 3 rings round points on the front,
# 4 labels, 5 names of curves, each x, y, colour, alignment, text. A block never is empty; what is nothing lies outside the axes.
load 'common.gp'
# A title that is too long for its canvas is written smaller; a character is about 0.54 em wide.
room = (width - left) / (0.54 * font_px)
shrink = strlen(title_text) > room ? room / strlen(title_text) : 1
title_font = sprintf('sans-serif,%.2f', shrink * (canvas eq 'png' ? font_px * 0.75 : font_px))
set label 1 title_text at screen (1.0 * left / width), screen (1 - 0.5 * top / height) left \
	textcolor rgb ink font title_font
set xlabel x_title textcolor rgb mute offset 0, 0.9
set xtics offset 0, 0.3
set xrange [x_first:x_last]
set yrange [y_first:y_last]
if (x_logarithmic) {
	set logscale x
	digits = digits_of(x_decades)
	set xtics ()
	do for [power = -4:12] { do for [digit in digits] {
		tick = digit * 10.0 ** power
		if (tick >= x_first && tick <= x_last) {
			set xtics add (sprintf('%.10g', tick) tick)
		}
	} }
}
if (y_logarithmic) {
	set logscale y
	digits = digits_of(y_decades)
	set ytics ()
	do for [power = -4:12] { do for [digit in digits] {
		tick = digit * 10.0 ** power
		if (tick >= y_first && tick <= y_last) {
			set ytics add (sprintf('%.10g', tick) tick)
		}
	} }
} else {
	set format y '%g'
	set ytics y_step
}
if (bound > 0) {
	set arrow 1 from first bound, graph 0 to first bound, graph 1 nohead linewidth 1.5 \
		dashtype (6, 5) linecolor rgb mute back
	set label 2 bound_text at first bound, graph 0.98 right rotate by 90 \
		offset character (bound_left ? 0.8 : -0.8), 0 textcolor rgb mute
}
label_font = sprintf('sans-serif,%d', canvas eq 'png' ? font_px * 0.62 : font_px * 0.82)
name_font = sprintf('sans-serif,%d', canvas eq 'png' ? font_px * 0.72 : font_px * 0.96)
plot 'data.tsv' index 0 using 1:2 with lines linewidth 9 linecolor rgb pale, \
	'' index 1 using 1:2:3 with lines linewidth 2 linecolor rgb variable, \
	'' index 3 using 1:2 with points pointtype 7 pointsize 1.5 linecolor rgb page, \
	'' index 3 using 1:2:3 with points pointtype 6 pointsize 1.5 linewidth 1.5 \
		linecolor rgb variable, \
	'' index 2 using 1:2:4:3 with points pointtype variable pointsize 0.8 \
		linecolor rgb variable, \
	'' index 4 using ($4 == -1 ? $1 : NaN):2:5 with labels right \
		textcolor rgb mute font label_font, \
	'' index 4 using ($4 == 0 ? $1 : NaN):2:5 with labels center \
		textcolor rgb mute font label_font, \
	'' index 4 using ($4 == 1 ? $1 : NaN):2:5 with labels left \
		textcolor rgb mute font label_font, \
	'' index 5 using ($4 == -1 ? $1 : NaN):2:5:3 with labels right \
		textcolor rgb variable font name_font, \
	'' index 5 using ($4 == 0 ? $1 : NaN):2:5:3 with labels center \
		textcolor rgb variable font name_font, \
	'' index 5 using ($4 == 1 ? $1 : NaN):2:5:3 with labels left \
		textcolor rgb variable font name_font
