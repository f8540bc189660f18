# Tables of scripts/benchmark_mvs.sh: rows.csv of each set (and what lies beside it: pair_*.txt and
# pair_*.names of cloud_comparer, score_truth.txt of demo_survey, poses.txt) -> mvs.csv, pairs.csv,
# mvs.md and mvs.dat in the folder `output`. Every cell says a figure or why there is none.
BEGIN {
  FS = ","
  measures[1] = "points"; measures[2] = "ETH3D"; measures[3] = "Tanks and Temples"
}

function cell(value, otherwise) { return value == "" ? otherwise : value }

function shorten(value, digits) { return value == "" ? "" : sprintf("%." digits "g", value) + 0 }

function ratio(above, below, format) {
  return above == "" || below == "" || below + 0 == 0 ? "" : sprintf(format, above / below)
}

# Of cloud_comparer's table: both clouds, and the scores by measure and distance.
function read_pair(base, set,    line, part, a, b, section, k) {
  getline line < (base ".names")
  split(line, part, ",")
  a = part[1]; b = part[2]
  num_pairs++
  pair_set[num_pairs] = set; pair_a[num_pairs] = a; pair_b[num_pairs] = b
  section = ""
  while ((getline line < (base ".txt")) > 0) {
    if (line ~ /^input +[0-9]+ /) { split(line, part, / +/); keep_cloud(set, a, part) }
    if (line ~ /^reference +[0-9]+ /) { split(line, part, / +/); keep_cloud(set, b, part) }
    if (line ~ /^points /) section = 1
    if (line ~ /^ETH3D /) section = 2
    if (line ~ /^Tanks and Temples /) section = 3
    if (line ~ /farther than/) section = "holes"
    if (section == "" || line ~ /farther than/ || line == "") continue
    sub(/^[A-Za-z][A-Za-z0-9 ]*[A-Za-z0-9D] +/, "", line)
    sub(/^ +/, "", line)
    split(line, part, / +/)
    if (section == "holes") {
      hole[num_pairs, part[1]] = part[2]; excess[num_pairs, part[1]] = part[3]
      continue
    }
    if (section == 1) distance[num_pairs, ++num_distances[num_pairs]] = part[1]
    accuracy[num_pairs, section, part[1]] = part[2]
    completeness[num_pairs, section, part[1]] = part[3]
    f_score[num_pairs, section, part[1]] = part[4]
  }
}

function keep_cloud(set, method, part) {
  points[set, method] = part[2]; spacing[set, method] = part[3]; area[set, method] = part[4]
  density[set, method] = part[5]; in_cell[set, method] = part[6]
}

function read_scores(path, set,    line, part, text) {
  while ((getline line < path) > 0) {
    split(line, part, ",")
    text = part[2]
    has_truth[set] = 1
    sub(/ (GSD|%|points.*|m2|mm) *$/, "", text)
    sub(/^.* /, "", text)
    if (part[2] ~ /^points within 1 GSD/) truth_1[set, part[1]] = text
    if (part[2] ~ /^points within 2 GSD/) truth_2[set, part[1]] = text
    if (part[2] ~ /^points within 4 GSD/) truth_4[set, part[1]] = text
    if (part[2] ~ /^median distance/) truth_median[set, part[1]] = text
    if (part[2] ~ /^of it with a point within 4 GSD/) truth_cover[set, part[1]] = text
  }
}

FNR == 1 {
  set = $1
  sets[++num_sets] = set
  pictures[set] = $3; megapixels[set] = $4
  folder = FILENAME
  sub(/rows\.csv$/, "", folder)
  command = "ls '" folder "'pair_*.names 2>/dev/null"
  while ((command | getline base) > 0) { sub(/\.names$/, "", base); read_pair(base, set) }
  close(command)
  read_scores(folder "score_truth.txt", set)
  getline poses[set] < (folder "poses.txt")
}

{
  method = $2
  n = ++num_methods[$1]
  methods[$1, n] = method
  if (!(method in known)) { known[method] = 1; all_methods[++num_all] = method }
  wall[$1, method] = $5; cpu[$1, method] = $6; gpu[$1, method] = $7; machine[$1, method] = $8
  peak[$1, method] = $9; cloud[$1, method] = $10; note[$1, method] = $11
  if (match($11, /^longer side [0-9]+ px/)) resolution[$1, method] = substr($11, 1, RLENGTH)
}

# The note without what is no reason for a missing figure.
function reason_of(set, m,    text) {
  text = note[set, m]
  sub(/^longer side [0-9]+ px(; )?/, "", text)
  return cell(text, "not given")
}

function label(set, m) {
  return m (resolution[set, m] == "" ? "" : ", " resolution[set, m])
}

function write_csv(    s, i, set, m) {
  file = output "/mvs.csv"
  print "set,method,pictures,megapixels,wall_s,cpu_s,cpu_s_per_megapixel,gpu,machine,peak_mb," \
    "points,spacing,area,points_per_unit2,points_per_cell,truth_within_1gsd,truth_within_2gsd," \
    "truth_within_4gsd,truth_median_gsd,truth_covered_4gsd,note" > file
  for (s = 1; s <= num_sets; ++s) {
    set = sets[s]
    for (i = 1; i <= num_methods[set]; ++i) {
      m = methods[set, i]
      print set "," m "," pictures[set] "," megapixels[set] "," wall[set, m] "," cpu[set, m] "," \
        ratio(cpu[set, m], megapixels[set], "%.4f") "," gpu[set, m] "," machine[set, m] "," \
        peak[set, m] "," points[set, m] "," spacing[set, m] "," area[set, m] "," \
        density[set, m] "," in_cell[set, m] "," truth_1[set, m] "," truth_2[set, m] "," \
        truth_4[set, m] "," truth_median[set, m] "," truth_cover[set, m] "," note[set, m] > file
    }
  }
}

function write_pairs_csv(    p, k, d, q) {
  file = output "/pairs.csv"
  print "set,input,reference,measure,distance,accuracy,completeness,f_score,hole_area," \
    "excess_area" > file
  for (p = 1; p <= num_pairs; ++p) {
    for (q = 1; q <= 3; ++q) {
      for (k = 1; k <= num_distances[p]; ++k) {
        d = distance[p, k]
        print pair_set[p] "," pair_a[p] "," pair_b[p] "," measures[q] "," d "," \
          accuracy[p, q, d] "," completeness[p, q, d] "," f_score[p, q, d] "," hole[p, d] "," \
          excess[p, d] > file
      }
    }
  }
}

function method_rows(set,    i, m, reason, why, truth) {
  print "| method | CPU s | CPU s a megapixel | wall s | peak MB | points | points a unit² | " \
    "points in a cell | within 1 / 2 / 4 GSD of the truth, covered | GPU; machine |" > md
  print "|---|---|---|---|---|---|---|---|---|---|" > md
  for (i = 1; i <= num_methods[set]; ++i) {
    m = methods[set, i]
    reason = reason_of(set, m)
    why = reason ~ /^not run/ ? "not run" : reason
    truth = truth_1[set, m] == "" ? (has_truth[set] ? why : "no truth") : \
      truth_1[set, m] " / " truth_2[set, m] " / " truth_4[set, m] " %, " truth_cover[set, m] " %"
    print "| " label(set, m) " | " cell(cpu[set, m], reason) " | " \
      cell(ratio(cpu[set, m], megapixels[set], "%.3f"), why) " | " cell(wall[set, m], why) " | " \
      cell(peak[set, m], why) " | " cell(points[set, m], why) " | " \
      cell(shorten(density[set, m], 4), why) " | " cell(in_cell[set, m], why) " | " truth " | " \
      cell(gpu[set, m], "none") "; " machine[set, m] " |" > md
  }
}

function pair_rows(set,    p, k, d) {
  print "\n| cloud | against | within | accuracy, completeness, F (Tanks and Temples) | " \
    "accuracy, completeness, F1 (ETH3D) | area of the second not near the first, and the reverse |" > md
  print "|---|---|---|---|---|---|" > md
  for (p = 1; p <= num_pairs; ++p) {
    if (pair_set[p] != set) continue
    if (pair_a[p] == pair_b[p]) {
      print "| " pair_a[p] " | not compared: it is the only cloud | - | - | - | - |" > md
      continue
    }
    for (k = 1; k <= num_distances[p]; ++k) {
      d = distance[p, k]
      print "| " pair_a[p] " | " pair_b[p] " | " d " | " accuracy[p, 3, d] ", " \
        completeness[p, 3, d] ", " f_score[p, 3, d] " | " accuracy[p, 2, d] ", " \
        completeness[p, 2, d] ", " f_score[p, 2, d] " | " shorten(hole[p, d], 3) ", " \
        shorten(excess[p, d], 3) " |" > md
    }
  }
}

# The first multi-view stereo with a time, else why there is none.
function find_mvs(set,    i, m) {
  mvs_method[set] = ""; mvs_why[set] = ""
  for (i = 1; i <= num_methods[set]; ++i) {
    m = methods[set, i]
    if (m ~ /^ours /) continue
    if (wall[set, m] != "") { mvs_method[set] = m; return }
    mvs_why[set] = mvs_why[set] (mvs_why[set] == "" ? "" : "; ") m ": " note[set, m]
  }
}

function seconds(value, why) { return value == "" ? why : value " s" }

function paper_row(name, figures, kind,    s, set, line, text) {
  line = "| " name " | " figures
  for (s = 1; s <= num_sets; ++s) {
    set = sets[s]
    if (kind == "poses") text = seconds(poses[set], "not measured here: the model came without a report")
    if (kind == "speed") text = "not run: no such pipeline here"
    if (kind == "mvs") text = mvs_method[set] == "" ? cell(mvs_why[set], "none") : \
      wall[set, mvs_method[set]] " s (" label(set, mvs_method[set]) ")"
    if (kind == "complete" || kind == "partial")
      text = seconds(wall[set, "ours " kind], note[set, "ours " kind])
    if (kind == "mvs ratio") text = mvs_method[set] == "" ? "no MVS" : \
      cell(ratio(wall[set, mvs_method[set]], wall[set, "ours partial"], "%.1f"), "no figure")
    if (kind == "mvs cpu ratio") text = mvs_method[set] == "" ? "no MVS" : \
      cell(ratio(cpu[set, mvs_method[set]], cpu[set, "ours partial"], "%.1f"), "no figure")
    if (kind == "ratio")
      text = cell(ratio(wall[set, "ours complete"], wall[set, "ours partial"], "%.2f"), "no figure")
    if (kind == "cpu ratio")
      text = cell(ratio(cpu[set, "ours complete"], cpu[set, "ours partial"], "%.2f"), "no figure")
    line = line " | " text
  }
  print line " |" > md
}

function paper_table(    s, line) {
  print "\n## The paper's Table 3, and these sets\n" > md
  print "The paper's four datasets in hours (a laptop with a 5-core Intel CPU at 2 GHz; \\* with an " \
    "Intel Iris GPU, \\*\\* on an i7-9700K with a GTX 1660 SUPER, † from images at a quarter of the " \
    "resolution); ours in seconds of wall time on the machine named above. Ratios are ours to work " \
    "out. Poses are as the workspace's report has them.\n" > md
  line = "| | Mermaid | Flying Fortress | Landingship Wreck | Lost Freediver Rock"
  for (s = 1; s <= num_sets; ++s) {
    line = line " | " sets[s] ", " pictures[sets[s]] " × " \
      ratio(megapixels[sets[s]], pictures[sets[s]], "%.1f") " megapixels"
    find_mvs(sets[s])
  }
  print line " |" > md
  line = "|---|---|---|---|---"
  for (s = 1; s <= num_sets; ++s) line = line "|---"
  print line "|" > md
  paper_row("SfM (accuracy-oriented)", "2.32 h \\* | 2.90 h \\* | 19.25 h \\*\\* | 37.17 h \\*", "poses")
  paper_row("SfM (speed-oriented)", "0.12 h † | 0.15 h † | 0.25 h † | 0.15 h †", "speed")
  paper_row("MVS", "30.15 h \\* | 24.65 h \\* | 34.17 h \\*\\* | 26.89 h \\*", "mvs")
  paper_row("Incremental (complete)", "2.81 h | 3.60 h | 6.08 h | 3.67 h", "complete")
  paper_row("Incremental (partial)", "0.74 h | 1.02 h | 1.77 h | 1.02 h", "partial")
  paper_row("MVS : partial", "40.7 | 24.2 | 19.3 | 26.4", "mvs ratio")
  paper_row("MVS : partial, CPU", "not given | not given | not given | not given", "mvs cpu ratio")
  paper_row("complete : partial", "3.80 | 3.53 | 3.44 | 3.60", "ratio")
  paper_row("complete : partial, CPU", "not given | not given | not given | not given", "cpu ratio")
}

function write_plots(    s, m, line, set, p, f) {
  file = output "/mvs.dat"
  line = "set"
  for (m = 1; m <= num_all; ++m) line = line "\tcpu " all_methods[m] "\tf " all_methods[m]
  print line > file
  for (s = 1; s <= num_sets; ++s) {
    set = sets[s]
    line = set
    for (m = 1; m <= num_all; ++m) {
      f = "?"
      for (p = 1; p <= num_pairs; ++p) {
        if (pair_set[p] != set || num_distances[p] < 2) continue
        if (pair_a[p] == all_methods[m] && pair_b[p] == "ours complete" ||
            pair_b[p] == all_methods[m] && pair_a[p] == "ours complete")
          f = f_score[p, 3, distance[p, 2]]
      }
      line = line "\t" cell(ratio(cpu[set, all_methods[m]], megapixels[set], "%.5f"), "?") "\t" f
    }
    print line > file
  }
  file = output "/mvs_methods.txt"
  for (m = 1; m <= num_all; ++m) print all_methods[m] > file
}

END {
  md = output "/mvs.md"
  print "# Densification against multi-view stereo\n" > md
  print "CPU is user + system of the whole program, reading pictures and finding SeaPoints " \
    "included where no database was there; peak is its resident memory. For the others " \
    "undistortion is included. Densities and points in a cell are of cloud_comparer, the same " \
    "cells for every method of a set. Distances are in units of the model.\n" > md
  for (s = 1; s <= num_sets; ++s) {
    print "## " sets[s] ": " pictures[sets[s]] " pictures, " shorten(megapixels[sets[s]], 4) \
      " megapixels\n" > md
    method_rows(sets[s])
    pair_rows(sets[s])
    print "" > md
  }
  paper_table()
  write_csv()
  write_pairs_csv()
  write_plots()
}
