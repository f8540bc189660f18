// The process as every command expects it, and its last word on stdout.
#pragma once

namespace colmap_seapoint {

// Once, before anything is opened or any thread is started:
// - Descriptors 0 to 2 that were closed by who started us are occupied, so that no output file of
//   ours takes one and gets the log among its bytes. What is written to them fails.
// - SIGXFSZ is ignored: a file that may not grow is an error of write(), with a line that says so.
// - SIGPIPE is ignored: who stops reading the log does not end hours of work. Results that nobody
//   takes are an error of FinishOutput().
// - SIGINT, SIGTERM and SIGHUP print one line, then end the process as they would have done. One
//   that was ignored by who started us (nohup) stays so.
// - Freed memory is kept for the next picture; the libraries beside us start no threads.
void SetUpProcess();

// Flushes stdout and throws Error when anything written there has not arrived (/dev/full, a closed
// pipe): a result that is lost is no success.
void FinishOutput();

}  // namespace colmap_seapoint
