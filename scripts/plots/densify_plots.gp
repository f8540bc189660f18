# Plots of densify.dat in the current folder: densify_cpu.png, densify_cover.png. One group a set,
# one bar a variant.
load system("dirname " . ARG0) . "/bars.gp"
# A set without a figure (no truth) keeps its place.
stats "densify.dat" using 0 nooutput
set xrange [-0.6:STATS_records - 0.4]
variants = "complete sequential complete_all all"

set output "densify_cpu.png"
set yrange [0:*]
set multiplot layout 2,1
set ylabel "CPU seconds a megapixel"
set title "Densification, CPU seconds a megapixel of picture"
plot for [v in variants] "densify.dat" using (column("cpu ".v)):xtic(1) title v
set ylabel "seconds"
set title "A local cloud, wall seconds, median"
plot for [v in variants] "densify.dat" using (column("pair ".v)):xtic(1) title v
unset multiplot

set output "densify_cover.png"
set multiplot layout 2,1
set ylabel "percent"
set yrange [0:100]
set title "Surface seen twice that has a point within 4 GSD"
plot for [v in variants] "densify.dat" using (column("coverage ".v)):xtic(1) title v
set ylabel "pairs"
set yrange [0:*]
set title "Pairs that gave points to the same place, mean"
plot for [v in variants] "densify.dat" using (column("layers ".v)):xtic(1) title v
unset multiplot
