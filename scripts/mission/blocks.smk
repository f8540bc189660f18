# A model's cloud in blocks, for densify_blocks.sh: each block wherever the engine runs it, then one
# cloud of all. What is done is not done again while pictures, model, options and program are the same.
import os
import sys

ARGUMENTS, BINARY, BLOCKS, THREADS, DIGEST = (
    os.environ["SEAPOINT_" + name]
    for name in ("ARGUMENTS", "BINARY", "BLOCKS", "THREADS", "DIGEST")
)
NUMBERS = range(1, int(BLOCKS) + 1)


localrules:
    all,


rule all:
    input:
        "fused.ply",


rule block:
    output:
        "block_{number}_of_" + BLOCKS + "/fused.ply",
    params:
        digest=DIGEST,
        folder=lambda wildcards: f"block_{wildcards.number}_of_{BLOCKS}",
    threads: int(THREADS)
    shell:
        "{BINARY:q} partial_densifier {ARGUMENTS} --output_path {params.folder:q}"
        " --block {wildcards.number}/{BLOCKS} --num_threads {threads}"


rule merge:
    input:
        expand(rules.block.output, number=NUMBERS),
    output:
        "fused.ply",
    params:
        digest=DIGEST,
        clouds=lambda wildcards, input: ",".join(input),
    shell:
        "{BINARY:q} cloud_merger --input_path {params.clouds:q} --output_path {output:q}"
