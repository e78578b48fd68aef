# Rules that run benchmarks.

peers: web ## measure the page beside other viewers in Chromium (npm, some minutes); ROUNDS=3
	B=$(B) SCENES=$(SCENES) sh tools/scripts/peers.sh $(or $(ROUNDS),3)

bench: all $(B)/tests/test_quality ## measure and write the tables of docs/measured.md
	SCENES=$(SCENES) B=$(B) sh tools/scripts/bench.sh

plot: $(B)/tests/test_pace ## draw docs/*.svg from the tables of docs/measured.md, and the simulation of test_pace
	@$(B)/tests/test_pace slow throttling bursty >$(B)/pace.txt
	@for plot in sizes growth levels budgets times pace; do \
	    table=docs/measured.md; [ $$plot != pace ] || table=$(B)/pace.txt; \
	    awk -v plot=$$plot -f tools/scripts/plot.awk $$table >docs/$$plot.svg.new && \
	        mv docs/$$plot.svg.new docs/$$plot.svg || { rm -f docs/$$plot.svg.new; exit 1; }; done

size: all ## code size of each part
	@sh tools/scripts/size.sh $(B)
