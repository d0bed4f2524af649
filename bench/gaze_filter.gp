# Jitter over lag, of what `gaze_filter FOLDER` wrote:
#   gnuplot -e "folder='FOLDER'; picture='jitter-over-lag.svg'" bench/gaze_filter.gp
set terminal svg size 720,480 font 'sans,13' background '#ffffff'
set output picture
set xlabel 'lag in saccades, samples at 500 Hz'
set ylabel 'step-to-step noise, of raw'
set xrange [-0.5:20]
set yrange [0:1]
set grid linecolor '#dddddd'
set key top right samplen 2
stats folder.'/pipeline.dat' using 2 nooutput
least = STATS_min
plot folder.'/one_euro.dat' with linespoints linewidth 2 pointtype 7 pointsize 0.5 \
	linecolor '#d95f02' title '1 € filter, beta swept', \
	folder.'/pipeline.dat' with linespoints linewidth 2 pointtype 7 pointsize 0.5 \
	linecolor '#1b9e77' title 'pipeline, smooth\_pass\_deg swept', \
	least with lines linewidth 2 dashtype 3 linecolor '#1b9e77' \
	title 'the best of it: more lag is of no use'
