# Plots of features.dat in the current folder: matched.png, area.png, cpu.png. One group a set, one
# bar a detector.
set terminal pngcairo size 1400,900 font "sans,11" background "white"
set datafile separator "\t"
set datafile missing "?"
set datafile columnheaders
set style data histograms
set style histogram clustered gap 1
set style fill solid 0.9 noborder
set linetype 1 linecolor rgb "#0072b2"
set linetype 2 linecolor rgb "#e69f00"
set linetype 3 linecolor rgb "#999999"
set grid ytics linecolor rgb "#dddddd"
set border 3
set tics nomirror out
set xtics rotate by -20
set key outside top center horizontal
detectors = "SeaPoints ORB SIFT"

set yrange [0:*]
set ylabel "percent"

set output "matched.png"
set multiplot layout 2,1
set title "Matched points, interpair (V, V+2), median"
plot for [d in detectors] "features.dat" using (column("matched_2 ".d)):xtic(1) title d
set title "Matched points, intrapair (V, V+1), median"
plot for [d in detectors] "features.dat" using (column("matched_1 ".d)):xtic(1) title d
unset multiplot

set output "area.png"
set multiplot layout 2,1
set title "Reliable shared area, interpair (V, V+2), median share of the picture"
plot for [d in detectors] "features.dat" using (column("area_2 ".d)):xtic(1) title d
set title "Reliable shared area, intrapair (V, V+1), median share of the picture"
plot for [d in detectors] "features.dat" using (column("area_1 ".d)):xtic(1) title d
unset multiplot

set output "cpu.png"
set ylabel "CPU seconds"
set logscale y
set yrange [0.001:*]
set multiplot layout 2,1
set title "Detection and description, CPU seconds a picture, median"
plot for [d in detectors] "features.dat" using (column("extract ".d)):xtic(1) title d
set title "Matching and filtering, CPU seconds a pair, median"
plot for [d in detectors] "features.dat" using (column("match ".d)):xtic(1) title d
unset multiplot
