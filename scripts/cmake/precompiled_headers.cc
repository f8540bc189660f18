// Nothing but what precompiled_headers.cmake adds.
