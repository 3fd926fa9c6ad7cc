"""What a person looks at: figures on matplotlib axes and the HTML page of one job."""
