# What every chart begins with: the canvas that settings.gp asks for, its colours and its margins.
load 'settings.gp'
set encoding utf8
set output 'chart.out'
if (canvas eq 'png') {
	set terminal pngcairo size 2 * width, 2 * height noenhanced background page \
		font sprintf('sans-serif,%d', font_px * 3 / 4) fontscale 2 linewidth 2 pointscale 2
} else {
	set terminal svg size width, height dynamic noenhanced \
		font sprintf('sans-serif,%d', font_px)
}
set datafile separator tab
set datafile missing 'nan'
set lmargin at screen (1.0 * left / width)
set rmargin at screen (1 - 1.0 * right / width)
set tmargin at screen (1 - 1.0 * top / height)
set bmargin at screen (1.0 * bottom / height)
set border 1 linewidth 1 linecolor rgb mute
set tics nomirror textcolor rgb mute
set grid linecolor rgb grid linewidth 1 linetype 1
unset key
# Digits that get a tick on a logarithmic axis of so many decades.
digits_of(decades) = decades > 2.5 ? '1' : decades > 1.1 ? '1 2 5' : '1 1.5 2 3 4 5 7'
