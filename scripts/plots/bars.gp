# How the benchmarks' bars look; the plots load it. A table with tabs, one group a row.
set terminal pngcairo size 1400,900 font "sans,11" background "white"
set datafile separator "\t"
set datafile missing "?"
set datafile columnheaders
set style data histograms
set style histogram clustered gap 1
set style fill solid 0.9 noborder
set linetype 1 linecolor rgb "#999999"
set linetype 2 linecolor rgb "#0072b2"
set linetype 3 linecolor rgb "#d0c8b0"
set linetype 4 linecolor rgb "#e69f00"
set grid ytics linecolor rgb "#dddddd"
set border 3
set tics nomirror out
set xtics rotate by -20 noenhanced
set key outside top center horizontal noenhanced
