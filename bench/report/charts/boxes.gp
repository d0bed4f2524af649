# Times of each variant, one under the other.
# data.tsv: row, name, least, first quartile, median, third quartile, 99 of 100, colour
load 'common.gp'
set label 1 title_text at screen (1.0 * left / width), screen (1 - 0.5 * top / height) left \
	textcolor rgb ink
# Not an xlabel: wider than the axes where names take half of the canvas.
set label 2 x_title at screen (1 - 1.0 * right / width), screen (0.28 * bottom / height) right \
	textcolor rgb mute
set xtics offset 0, 0.3
set logscale x
set xrange [x_first:x_last]
set yrange [rows - 0.4:-0.6]
digits = digits_of(x_decades)
set xtics ()
do for [power = -4:12] { do for [digit in digits] {
	tick = digit * 10.0 ** power
	if (tick >= x_first && tick <= x_last) {
		set xtics add (sprintf('%.10g', tick) tick)
	}
} }
set grid xtics noytics
set ytics scale 0 textcolor rgb ink
set style fill solid 0.25 border
# On a narrow canvas names beside the boxes would leave them no room: each stands above its own.
half = names_above ? 0.17 : 0.28
down = names_above ? 0.2 : 0
if (names_above) {
	unset ytics
}
plot 'data.tsv' using 3:($1 + down):($7 - $3):(0):8 with vectors nohead linewidth 1.5 \
		linecolor rgb variable, \
	'' using 4:($1 + down):4:6:($1 + down - half):($1 + down + half):8:\
		ytic(2) with boxxyerror linewidth 1.5 \
		linecolor rgb variable, \
	'' using 5:($1 + down - half):(0):(2 * half):8 with vectors nohead linewidth 4 \
		linecolor rgb variable, \
	'' using (x_first):(names_above ? $1 - 0.24 : NaN):2 with labels left textcolor rgb ink
