; Whether a sample gets into a reader's cache. LLVM makes writer_filter.CODE of this: the test
; beside it compiles it and compares.
;
; %info   dds_sample_info_t: the handle of the writer is its fifth word of eight bytes
; %state  handle of the writer that is kept to (0: of all), count of samples kept out

define zeroext i8 @keeps(ptr %info, ptr %state) {
  %writer = load i64, ptr %state
  %all = icmp eq i64 %writer, 0
  br i1 %all, label %keep, label %compare

compare:
  %at = getelementptr i64, ptr %info, i64 4
  %from = load i64, ptr %at
  %own = icmp eq i64 %from, %writer
  br i1 %own, label %keep, label %drop

drop:
  %place = getelementptr i64, ptr %state, i64 1
  %count = load i64, ptr %place
  %more = add i64 %count, 1
  store i64 %more, ptr %place
  ret i8 0

keep:
  ret i8 1
}
