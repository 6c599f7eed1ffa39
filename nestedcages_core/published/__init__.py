"""Methods as they were published, one package per paper, behind the same protocols as ours."""
